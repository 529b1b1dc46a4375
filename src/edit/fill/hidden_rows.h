// Gaussians of a room that no photo shows, because what is removed now hid them.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/fill_room.h"

namespace aligngs {

/// Marks the Gaussians that only the removed objects hid, as far as nobody can believe them. `debris` is per row; marked
/// rows stay marked. Those of walls, floor and ceiling go. Those of a thing go in two cases:
/// - the rest of the thing has no such colour. Its unseen side has mostly the colour of the seen one;
/// - they are wide. No photo has bounded them, and they reach far into the room that is seen now.
void mark_hidden_rows(const FillRoom& room, std::vector<uint8_t>& debris);

}  // namespace aligngs
