// The room as those see it who plan its views: free places, points of the surface, and what an eye sees of them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "synth/raytracer.h"
#include "synth/trajectory.h"
#include "synth/walkable_floor.h"

namespace aligngs {

/// Everything the planning steps share.
struct ViewPlanner {
  const RoomRays& scene;
  const TrajectoryOptions& options;
  ThreadPool& pool;
  WalkableFloor walkable;
  Random random;
  Vec3d up;                            ///< world
  std::vector<Vec3d> points, normals;  ///< on the surface, world: by them views are judged

  ViewPlanner(const RoomRays& s, const TrajectoryOptions& o, ThreadPool& p);

  Vec3d world(const Vec2d& floor, double height) const;
  Camera camera(const Rigidd& pose) const;
  /// Per surface point: whether the eye sees it, from any direction.
  std::vector<uint8_t> visible_from(const Vec3d& eye) const;
  /// Distance from the eye to the nearest surface in 26 directions.
  double clearance(const Vec3d& eye) const;

 private:
  /// Points by area, kept when they can be seen from somewhere a camera can be.
  void sample_surface();
};

}  // namespace aligngs
