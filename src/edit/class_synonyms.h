// Everyday words for the classes of ADE20K: one table, one line per class.
#pragma once

#include <span>
#include <string_view>

namespace aligngs {

struct ClassSynonyms {
  std::string_view name;   ///< of the class, as in scene/ade20k_labels.cpp
  std::string_view words;  ///< separated by ';'; no word of another class's own names is among them
};

/// Words that people type and the data set's own list lacks. They serve every label set that has the class name.
std::span<const ClassSynonyms> everyday_synonyms();

}  // namespace aligngs
