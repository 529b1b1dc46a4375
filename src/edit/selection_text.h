// The text that says which objects are meant: "pillow, cushion#2", "everything but wall, floor".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "edit/selection_term.h"
#include "edit/vocabulary.h"

namespace aligngs {

struct SelectionQuery {
  bool everything = false;             ///< also what has no label
  std::vector<SelectionTerm> include;  ///< united
  std::vector<SelectionTerm> exclude;  ///< taken away afterwards
};

/// Grammar: items parted by commas (or "and", "or", "&"). An item is a name, optionally with "#" and object numbers
/// ("bed#2", "bed#1-3", "bed 2", "the second bed"). "All", "every" or "the" may precede it. "Largest", "smallest",
/// "left", "right", "highest" or "lowest" before it choose one object. "#2" alone is of the name before it, and so is
/// "2" after a number. "The pillow on the bed" tells its place (relation_words.h), and "all furniture" is a group of
/// classes (class_groups.h). "everything" or "all" is the whole room; after "but", "except", "apart from" or the like
/// are the exclusions. An item that is the name of a
/// selection (Vocabulary::add_selection) means that selection.
/// Error{kUsage} for empty text, unknown names (with suggestions), and bad object numbers.
SelectionQuery parse_selection(std::string_view text, const Vocabulary& vocabulary);

/// Sorts terms, and leaves each one once.
void sort_terms(std::vector<SelectionTerm>& terms);

/// The same selection in one spelling, for edits.json and messages; parse_selection reads it back once meant_objects.h
/// has found the objects.
std::string selection_text(const SelectionQuery& query, const LabelSet& labels);

/// How sure a Gaussian must be to be selected.
struct ThresholdRule {
  enum class Kind {
    kArgmax,  ///< the class is the Gaussian's most probable one
    kAuto,    ///< its probability is above the split of the class's histogram (Otsu 1979)
    kValue    ///< the probability of the named classes together is at least `value`
  };
  Kind kind = Kind::kArgmax;
  double value = 0;  ///< in (0, 1], for kValue
};

/// "argmax", "auto" or a number in (0, 1]; Error{kUsage} for anything else.
ThresholdRule parse_threshold(std::string_view text);
std::string threshold_text(const ThresholdRule& rule);

}  // namespace aligngs
