// Ways of a camera through a room that nobody had to draw: around its middle, and past the places of the photos.
#pragma once

#include <vector>

#include "room/room_inside.h"
#include "scene/camera_path.h"

namespace aligngs {

/// Once around the place that the photos look at, at their height, as far from it as walls and obstacles allow. A loop.
/// `photos`: at least one camera, world. The room's obstacles are those at tour_height().
CameraPath orbit_path(const RoomInside& room, const std::vector<Camera>& photos, double seconds);

/// Past at most twelve places of the photos on a short way, looking where they look. It goes evenly.
CameraPath walk_path(const RoomInside& room, const std::vector<Camera>& photos, double seconds);

/// The height above the floor (room units) at which both go: the median of the photos, below the ceiling.
double tour_height(const RoomInside& room, const std::vector<Camera>& photos);

}  // namespace aligngs
