// The objects that words mean: numbers for "the largest chair", "the pillow on the bed" and "all furniture".
#pragma once

#include "edit/relation/room_objects.h"
#include "edit/selection_text.h"

namespace aligngs {

/// Whether the words ask for more than names and numbers tell.
bool asks_objects(const SelectionQuery& query);

/// The query with numbers. Error{kBadInput} where no object fits, and where more fit than are meant: it names those
/// that could be meant. One that is near something is meant where the next one is more than twice as far.
SelectionQuery with_numbers(SelectionQuery query, const RoomObjects& objects);

}  // namespace aligngs
