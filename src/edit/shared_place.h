// A place after two names: "the pillows and the cushions on the armchair".
#pragma once

#include <string>
#include <vector>

#include "edit/selection_item.h"
#include "edit/selection_term.h"
#include "scene/label_set.h"

namespace aligngs {

/// A name without a place, and its first term.
struct BareName {
  std::string text;
  size_t term = 0;
};

/// Error{kUsage} with both readings where names before a thing with a place may be in that place, too: all pillows, or
/// those on the armchair. `terms[placed]` is the first term of the thing, whose words are `after`.
void require_own_place(const std::vector<BareName>& bare, const RelatedItem& after,
                       const std::vector<SelectionTerm>& terms, size_t placed, const LabelSet& labels);

}  // namespace aligngs
