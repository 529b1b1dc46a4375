// Planes of walls, floor and ceiling of an edited room, from its own labelled Gaussians.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/carrying_classes.h"
#include "edit/fill/plane_grid.h"
#include "edit/selection.h"
#include "scene/camera.h"

namespace aligngs {

/// One plane of the room's shell. The normal points into the room.
struct RoomPlane : PlaneOf {
  PlaneKind kind = PlaneKind::kNone;
  std::vector<uint32_t> carriers;  ///< rows of the Gaussians of its class on it
  Vec3d low, high;                 ///< box around the carriers, world
};

struct RoomPlaneSettings {
  double tolerance = 0.010;  ///< / extent: a carrier is nearer to its plane (3 cm in a room)
  double facing = 0.8;       ///< cosine between a carrier's shortest axis and the plane's normal
  size_t least_carriers = 40;
  float solid = 0.3f;  ///< opacity of a Gaussian that is part of a surface
};

/// A place in the room: the mean place of the cameras, or of the Gaussians where no camera is known.
Vec3d place_inside(const LabelledGaussians& room, const std::vector<Camera>& cameras);

/// `inside` is a place in the room (place_inside). `left_out` marks rows that say nothing: those
/// that go. The same for the same room.
std::vector<RoomPlane> room_planes(const LabelledGaussians& room, const std::vector<CarryingClass>& classes,
                                   const std::vector<uint8_t>& left_out, const Vec3d& inside,
                                   const RoomPlaneSettings& settings = {});

/// Whether the plane has a surface at the foot of a place, or within `reach` of it along each axis.
bool has_surface_at(const RoomPlane& plane, const Vec3d& place, double reach);

/// Whether a place is in the room as far as its planes tell: not behind a plane that has a surface near there.
bool is_inside(const Vec3d& place, const std::vector<RoomPlane>& planes, double tolerance, double reach);

}  // namespace aligngs
