// An edit as a person types it into the page: "delete pillow, cushion", "recolor sofa to #add8e6".
#pragma once

#include <string_view>

#include "edit/edit_operation.h"

namespace aligngs {

/// A verb, then a selection (selection_text.h), then what the operation needs. Verbs: delete or remove, extract or
/// keep, recolor or recolour, highlight. A colour is at the end, after "to", "in" or "with" or by itself; highlighting
/// can do without. "--fill" and "--threshold X" mean what they mean on the command line. Reads back every describe() of
/// an edit. Error{kUsage} for anything else; the selection is only checked against a label set when it is applied.
EditOperation parse_edit(std::string_view text);

}  // namespace aligngs
