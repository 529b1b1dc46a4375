// The furniture of a room as points, from which room.json has its boxes.
#pragma once

#include <vector>

#include "edit/apply_edit.h"
#include "room/furniture.h"

namespace aligngs {

/// Surface points of the furniture of a room: vertices of its mesh, or where there is none centres of its Gaussians.
std::vector<ObjectPoints> furniture_points(const EditableRoom& room, ThreadPool& pool);

}  // namespace aligngs
