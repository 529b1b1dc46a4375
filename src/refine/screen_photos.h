// Photos of a screen, and how well they agree with a plane for it.
#pragma once

#include <algorithm>
#include <vector>

#include "refine/screens.h"

namespace aligngs {

Vec3d ray_in_world(const Camera& camera, double u, double v);

/// Shared input of the steps of place_screens().
struct ScreenPhotos {
  const std::vector<PlaneView>& views;
  const std::vector<ScenePlane>& planes;
  const ScreenSettings& settings;
  std::vector<ImageF> gradients;  ///< of the photos' luma

  const Camera& camera(const ScreenRegion& region) const { return views[region.view].camera; }
  /// Ray of the middle of a region, z = 1.
  Vec3d middle_ray(const ScreenRegion& region) const;
  Vec3d middle_at(const ScreenRegion& region, double depth) const;
  WorldPlane plane_at(const ScreenRegion& region, const Vec3d& normal, double depth) const;
  /// Depth of the middle of a region on a plane; 0: not before the camera, or the plane is seen from behind.
  double depth_on(const ScreenRegion& region, const WorldPlane& plane) const;
  /// Directions that the screen may face.
  std::vector<Vec3d> normals_for(const ScreenRegion& region) const;
  bool is_in_room(const ScreenRegion& region, double depth) const;

  /// How well the other photos agree with a region's outline on a plane, in [0, 1], each weighed by the angle that it
  /// looks from.
  double agreement_of(const ScreenRegion& region, const WorldPlane& plane) const;
  double mean_agreement(const std::vector<ScreenRegion>& regions, const std::vector<size_t>& of,
                        const WorldPlane& plane) const;
  /// Between the log depths of planes that are tried.
  double log_step() const { return 2 * settings.range / std::max(1, settings.hypotheses - 1); }
  /// The planes that the other photos agree with best, as one photo's outline asks them.
  std::vector<WorldPlane> candidates(const ScreenRegion& region) const;
};

}  // namespace aligngs
