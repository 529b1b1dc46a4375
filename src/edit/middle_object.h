// The middle one of objects in a row.
#pragma once

#include <string>
#include <vector>

#include "edit/relation/room_objects.h"

namespace aligngs {

/// The middle one of an odd number of objects in a row, in whatever direction. Error{kBadInput} for an even number, and
/// where they are no row. `what` is in the message.
size_t middle_object(const RoomObjects& objects, const std::vector<size_t>& candidates, const std::string& what);

}  // namespace aligngs
