// room.json with the edits of a run: its furniture and openings as the edits left them.
#pragma once

#include <optional>

#include "edit/apply_edit.h"
#include "room/measured_room.h"

namespace aligngs {

/// The room with the boxes of the furniture of `edited`, and without openings whose Gaussians are gone for the most
/// part. `trained` is the room before its edits; walls, floor and ceiling are measured on it alone. Nothing where the
/// boxes are of an earlier program, which does not tell what photos show of them.
std::optional<MeasuredRoom> followed_room(const MeasuredRoom& measured, const EditableRoom& trained,
                                          const EditableRoom& edited, ThreadPool& pool);

}  // namespace aligngs
