// Motions of sentences in the unit of a room, and toward its things.
#pragma once

#include <optional>

#include "edit/apply_edit.h"

namespace aligngs {

/// The motion of an edit in scene units, and to the right, upwards and towards the viewer alone. "50 cm towards the
/// window" begins at the middle of the selected objects, is level, and ends before the middle of the thing.
/// `metres` is the length of a scene unit, where it is known; motions in scene units do not need it. Error{kBadInput} for a length in metres where it is not
/// known. The same for a thing that is several objects, and for one that is too near. Errors of read_selection(), too.
void settle_motion(const EditableRoom& room, std::optional<double> metres, EditOperation& edit);

}  // namespace aligngs
