// Some objects of a room for a file of their own.
#pragma once

#include <string>

#include "edit/apply_edit.h"

namespace aligngs {

/// The Gaussians and triangles of the named objects, at their places, as the nodes of a GLB have them. `text`: a
/// selection (selection_text.h); "pillow.002", the name of a node, means "pillow#2". Errors as read_selection's;
/// Error{kBadInput} when the room has no such object.
EditableRoom chosen_objects(const EditableRoom& room, const std::string& text, ThreadPool& pool);

}  // namespace aligngs
