// The room's own frame: z up, the floor at zero, the longest wall along x.
#pragma once

#include <optional>
#include <vector>

#include "core/rigid.h"
#include "refine/scene_planes.h"

namespace aligngs {

struct RoomFrameSettings {
  /// degrees from upright within which a wall plane is a wall: a trained wall leans by 1 or 2
  double upright_angle = 12;
  double level_angle = 20;  ///< degrees from level within which a floor plane may be the floor
};

/// Planes of a room by kind. Indices into the planes that were given.
struct RoomFrame {
  Rigidd to_room;  ///< world to the frame; the origin is not yet in a corner
  std::optional<size_t> floor;
  std::vector<size_t> walls, ceilings;
};

/// `up`: what the scene knows; a floor or ceiling plane that is nearly level replaces it. Nothing where neither says
/// which way is up.
/// Without a floor plane z = 0 is the world's origin, until the surfaces say more. Planes that are not finite are left
/// out.
std::optional<RoomFrame> find_room_frame(const std::vector<ScenePlane>& planes, const std::optional<Vec3d>& up,
                                         const RoomFrameSettings& settings = {});

/// A rotation that takes `up`, unit, to z. x runs along a wall with this normal; without, along any level direction.
Mat3d upright_rotation(const Vec3d& up, const std::optional<Vec3d>& wall_normal = {});

/// A plane of the world in the frame.
ScenePlane in_frame(const ScenePlane& plane, const Rigidd& to_room);

}  // namespace aligngs
