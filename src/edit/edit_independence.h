// Whether an edit stays what it is when an earlier one is taken back.
#pragma once

#include "edit/edit_change.h"

namespace aligngs {

/// True when nothing of `later` follows from `taken`. They are apart in space, and `later` uses no row that `taken`
/// made.
/// It neither asks for a class that `taken` touched nor has new rows of it. After an edit of colours alone the room has
/// the same shape. Then only `later`'s own colours and new rows can follow from it. When in doubt: false.
bool is_independent(const EditChange& taken, const EditChange& later);

}  // namespace aligngs
