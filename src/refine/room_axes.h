// The directions of a room that is built square, estimated from its planes: nothing says that there are any, or where
// up is.
#pragma once

#include <optional>
#include <vector>

#include "refine/scene_planes.h"

namespace aligngs {

struct RoomAxesSettings {
  double angle = 4;          ///< degrees within which a plane faces along an axis
  double least_share = 0.7;  ///< of the planes' points whose planes do; less, and the room is not square
};

/// Three directions at right angles (Manhattan world, Coughlan and Yuille 1999).
struct RoomAxes {
  Mat3d axes;  ///< unit columns, world, right-handed
  /// the column (or its opposite) that floors face and ceilings face away from; nothing without either
  std::optional<Vec3d> up;
  double share = 0;  ///< of the planes' points whose planes face along an axis
};

/// From the planes' normals, each weighed by its points. Nothing without two planes at a right angle, or when too many
/// face otherwise.
std::optional<RoomAxes> estimate_room_axes(const std::vector<ScenePlane>& planes,
                                           const RoomAxesSettings& settings = {});

/// Turns every plane that faces along an axis about its centre until it does so exactly; the others stay.
std::vector<ScenePlane> squared_planes(std::vector<ScenePlane> planes, const RoomAxes& axes,
                                       const RoomAxesSettings& settings = {});

}  // namespace aligngs
