// Objects at another place: moved, turned and copied.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid.h"
#include "edit/apply_edit.h"
#include "edit/object_motion.h"

namespace aligngs {

/// The motion of the selected Gaussians in the world. Error{kBadInput} when the room does not tell which way is up,
/// when no camera is known, or when the cameras are right above the objects.
Similarity motion_in_world(const EditableRoom& room, const std::vector<uint8_t>& selected, const ObjectMotion& motion);

/// How far to the right a copy is beside its original: the width of the box, and a gap. Errors as motion_in_world's.
double step_aside(const EditableRoom& room, const std::vector<uint8_t>& selected);

/// The selected Gaussians and vertices as a room of their own.
EditableRoom piece_of(const EditableRoom& room, const std::vector<uint8_t>& selected,
                      const std::vector<uint8_t>& vertices);

/// Gaussians of other objects that came along, a few of each, become Gaussians of the object that the piece is of. A
/// piece has an object when at least half of it came. Without one nothing changes.
void claim_neighbours(EditableRoom& piece, const EditableRoom& room);

/// Adds a piece of the same run. Its Gaussians count as made by an edit (GaussianOrigin::filled).
void add_piece(EditableRoom& room, const EditableRoom& piece);

/// Gives the objects of a piece numbers that the room does not use. Classes stay.
void number_anew(EditableRoom& piece, const EditableRoom& room);

}  // namespace aligngs
