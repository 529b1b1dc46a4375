// Puts an object from elsewhere in the place of selected ones.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid.h"
#include "edit/inserted_object.h"

namespace aligngs {

/// From the object's world to the room's: upright, turned to the wall behind the selected Gaussians, and with its foot
/// where theirs is. Its back is where theirs is, when they have a wall behind them; else its middle is. `turn` in degrees,
/// counter-clockwise seen from above. With `fit` it is scaled to the box of the selection, without changing its shape.
/// The identity for an object that is placed already. Error{kBadInput} when the room has no up direction, or the object
/// no size.
Similarity placement_of(const EditableRoom& room, const std::vector<uint8_t>& selected, const InsertedObject& object,
                        double turn, bool fit);

/// The object with labels of the room, as add_piece() takes it. It has its class where the room's label set has it, else
/// that of most selected Gaussians. Its number is one that the room does not use. Harmonics beyond the room's degree are gone.
EditableRoom labelled_for(const EditableRoom& room, const std::vector<uint8_t>& selected, const InsertedObject& object);

}  // namespace aligngs
