// Reads one item of a selection: "bed#1-3", "the second bed", "the largest pillow on the bed".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edit/selection_term.h"
#include "edit/vocabulary.h"

namespace aligngs {

/// An item that tells the place of its objects, in two parts.
struct RelatedItem {
  std::string_view target;                  ///< "pillow"
  std::string_view place;                   ///< "on the bed"
  ObjectChoice side = ObjectChoice::kNone;  ///< of "the pillow on the bed on the left"
  std::string_view row{};                   ///< " from the left" of "the second book on the shelf from the left"
  bool negated = false;                     ///< "the pillows not on the bed"
};

/// Nothing where the item is a name, or tells no place.
std::optional<RelatedItem> related_item(std::string_view item, const Vocabulary& vocabulary);

/// Adds the terms of an item. One object with a place is meant as one: "the pillow on the bed". "All pillows on the
/// bed" are any number. Error{kUsage} for unknown names (with suggestions), and bad object numbers.
void parse_item_terms(std::string_view item, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms);

}  // namespace aligngs
