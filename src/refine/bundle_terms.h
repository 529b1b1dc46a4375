// Residuals of an observation, and their derivatives by its camera, its point and the scale of its view's depth.
#pragma once

#include <array>
#include <vector>

#include "core/vector_lanes.h"
#include "scene/camera.h"

namespace aligngs {

/// Nearer points have no projection, scene units.
inline constexpr double kNearestPoint = 1e-6;

/// Numbers of a view that a bundle adjustment changes, in the order of its lanes. A turn (rotation vector, radians)
/// happens in the camera's frame, a shift moves the centre in the world. All views share the focal length.
enum ViewLane { kTurnLane = 0, kShiftLane = 3, kFocalLane = 6, kScaleLane = 7 };
static_assert(kScaleLane + 1 == kLanes);

/// The camera after a step of its lanes; the scale's has no part in it.
Camera moved_camera(const Camera& camera, const Lanes& step);

/// Everything that a bundle adjustment changes, at one moment: of the views that take part, and all points.
struct BundleState {
  std::vector<Camera> cameras;
  std::vector<Vec3d> points;
  std::vector<double> log_scales;  ///< of a view's prior depth
  double log_focal = 0;            ///< against the start; `cameras` have it already
};

/// An observation, prepared.
struct BundleTerm {
  int view = 0;  ///< of a BundleState
  int point = 0;
  Vec2d pixel;
  std::array<double, 3> whitening;  ///< of errors in pixels: match_covariance.h
  double log_depth = 0;
  double depth_sigma = 0;  ///< relative; 0: no prior depth
};

/// Residuals of a term over their deviations: two of its place, and one of its log depth if it has one. The weights are
/// those of the Cauchy loss for iteratively reweighted least squares: 1 / (1 + squared error).
struct TermRows {
  int rows = 0;
  double residual[3];
  double weight[3];
  Lanes by_view[3];
  Vec3d by_point[3];
};

/// Half the Cauchy loss of a term: log(1 + squared error) / 2, of place and depth. Infinite behind the camera.
double term_cost(const BundleTerm& term, const BundleState& state);

/// False behind the camera.
bool linearise(const BundleTerm& term, const Camera& camera, const Vec3d& point, double log_scale, TermRows& out);

}  // namespace aligngs
