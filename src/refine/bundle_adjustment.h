// Cameras, one focal length and points that agree with each other, and not further from the prior than it is wrong.
#pragma once

#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "refine/match_covariance.h"
#include "scene/camera.h"

namespace aligngs {

/// A point seen at `pixel` of view `view`; `prior_depth` is that of the prior there, 0 = none.
struct Observation {
  int view = 0;
  int point = 0;
  Vec2d pixel;
  double prior_depth = 0;
  MatchCovariance covariance;  ///< of `pixel`, beside BundleSettings::pixel
};

/// How wrong the starting values are (standard deviations), and when an observation is an outlier.
struct BundleSettings {
  double rotation = 1;            ///< degrees, per camera
  double centre = 0.02;           ///< of the extent, per camera
  double focal = 0.03;            ///< relative, of the shared focal length; 0 = fixed
  double depth = 0.03;            ///< relative, of prior depth at a pixel
  double depth_independent = 12;  ///< a view's depth is bent, not noisy: its pixels are worth so many independent ones
  double depth_scale = 0.02;      ///< relative, of a view's prior depth as a whole
  /// pixels, of a match, beside its own covariance; from their sum on the Cauchy loss takes it for an outlier
  double pixel = 0.1;
  int iterations = 50;  ///< at most
  /// stops when an iteration brings less, relative to the cost: more moves no camera by as much as it is wrong
  double tolerance = 1e-6;
};

struct BundleProblem {
  std::vector<Camera> cameras;  ///< in: the prior; out: refined
  std::vector<Camera> anchors;  ///< what the pose priors pull to; empty: `cameras` as given
  std::vector<bool> fixed;      ///< cameras that stay; empty = none
  std::vector<Vec3d> points;    ///< in: a start; out: refined
  bool fixed_points = false;    ///< resection: only cameras move
  std::vector<Observation> observations;
  double extent = 1;                ///< of the scene, scene units
  std::vector<double> depth_scale;  ///< out: per view, factor on its prior depth
  double focal_factor = 1;          ///< out: on every focal length
};

struct BundleReport {
  double start_rms = 0, end_rms = 0;  ///< pixels, over all observations
  double start_median = 0, end_median = 0;
  int iterations = 0;
  bool converged = false;
};

/// Minimises robust reprojection errors (Cauchy loss), log-depth factors and priors of poses, scales and focal length.
/// Levenberg-Marquardt with points eliminated, dense in the cameras: made for tens of views. Observations behind a camera
/// are left out. Without observations, or with one that is not finite, nothing changes. The same bits for any number of
/// threads.
BundleReport adjust_bundle(BundleProblem& problem, const BundleSettings& settings, ThreadPool& pool);

/// Reprojection error of an observation, pixels; infinite behind the camera.
double reprojection_error(const Camera& camera, const Vec3d& point, const Vec2d& pixel);

}  // namespace aligngs
