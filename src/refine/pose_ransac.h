// The pose that most matches of a photo agree with, however many are wrong and however far it is from where they were
// expected.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/camera.h"

namespace aligngs {

/// A point whose place is known, and where the photo seems to show it.
struct PointMatch {
  Vec3d point;  ///< scene units
  Vec2d pixel;
};

struct PoseSearchSettings {
  int samples = 2000;    ///< of three matches each: one in a hundred is right where a fifth of the matches are
  double agreement = 2;  ///< pixels between a match and where its point is projected to
  /// degrees from the pose where the search begins; beyond, three wrong matches were taken
  double largest_turn = 15;
  uint64_t seed = 1;
};

struct RansacPose {
  Camera camera;
  int agreeing = 0;  ///< matches
};

/// RANSAC (Fischler and Bolles 1981): a pose through three matches at a time, by Gauss-Newton from `start`, whose lens
/// is kept. The best is fitted once more to all that agree with it. Nothing for fewer than four matches, or when no
/// sample has a pose near `start` that a fourth match agrees with. The same for the same input.
std::optional<RansacPose> ransac_pose(const Camera& start, const std::vector<PointMatch>& matches,
                                      const PoseSearchSettings& settings);

}  // namespace aligngs
