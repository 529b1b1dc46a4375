// A room in its own frame, as room.json has it: the floor at zero, walls along the axes, in metres where the scale is
// known.
#pragma once

#include "core/rigid.h"
#include "edit/apply_edit.h"

namespace aligngs {

/// The world of exports: that of room.json with y down, as splat files have it, so that (x, y, z) becomes (x, -z, y).
Similarity export_frame(const Similarity& to_room);

/// Gaussians, mesh and up in that world. Objects keep their names.
EditableRoom aligned(EditableRoom room, const Similarity& to_room);

}  // namespace aligngs
