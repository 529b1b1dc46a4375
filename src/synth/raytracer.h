// Ray casts against a room (Embree), safe from many threads.
#pragma once

#include <memory>

#include "scene/camera.h"
#include "synth/room_model.h"

namespace aligngs {

struct RayHit {
  bool hit = false;
  double distance = 0;    ///< along the direction, in units of its length
  uint32_t triangle = 0;  ///< index into RoomModel::triangles
  float u = 0, v = 0;     ///< barycentric weights of the triangle's second and third vertex
};

/// An acceleration structure over a room that stays where it is while this lives. Built by one thread, so that
/// the same room gives the same hits whatever the machine's thread count.
class RoomRays {
 public:
  /// Throws Error{kResources} when Embree cannot get its memory.
  explicit RoomRays(const RoomModel& room);
  ~RoomRays();
  RoomRays(const RoomRays&) = delete;
  RoomRays& operator=(const RoomRays&) = delete;

  /// First surface along origin + t * direction, t > near. The distance is that to the triangle's plane in double
  /// precision.
  RayHit intersect(const Vec3d& origin, const Vec3d& direction, double near = 1e-4) const;
  /// Whether anything lies strictly between origin + near * direction and origin + far * direction.
  bool occluded(const Vec3f& origin, const Vec3f& direction, float near, float far) const;
  /// Whether the segment between the points is free, but for `slack` metres at the end.
  bool visible(const Vec3d& from, const Vec3d& to, double slack = 0.01) const;

  const RoomModel& room() const { return room_; }

 private:
  struct Handles;
  const RoomModel& room_;
  std::unique_ptr<Handles> handles_;
};

}  // namespace aligngs
