// An edit as a person types it: "delete pillow, cushion", "recolor sofa dark green", "undo the second edit".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edit/edit_operation.h"
#include "edit/undo_words.h"

namespace aligngs {

/// A verb, then a selection (selection_text.h), then what the operation needs. Verbs: delete or remove, extract or
/// keep, move or push, turn or rotate, duplicate or copy (motion_text.h), replace, highlight, and recolor. Recolour,
/// paint, color and colour are recolor. A colour (color_names.h) is at the end, after "to", "in" or "with" or by itself.
/// Highlighting can do without. "Replace sofa with chair.ply" may end in ", fitted", ", up -y" and " and turn by 90".
/// A deletion fills its hole, as the button of the page does, unless the text says "--no-fill" or ", hole left open".
/// "With contents" (or "and what is on it") takes along things on the objects. "--fill" and "--threshold X" mean what
/// they mean on the command line. Reads back every describe() of an edit. Error{kUsage} for anything else; the selection
/// is only checked against a label set when it is applied.
EditOperation parse_edit(std::string_view text);

/// The verbs of parse_edit().
std::vector<std::string> edit_verbs();

/// An edit, or the wish to take some back.
struct EditRequest {
  std::optional<UndoRequest> undo;
  EditOperation edit;  ///< where `undo` is empty
};

/// "undo", "undo the last two edits" (undo_words.h), or an edit. Errors as parse_undo's and parse_edit's.
EditRequest parse_request(std::string_view text);

}  // namespace aligngs
