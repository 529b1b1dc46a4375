#include "refine/bundle_adjustment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/angles.h"
#include "core/error.h"
#include "core/median.h"

#ifdef ALIGNGS_WITH_CERES
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#endif

namespace aligngs {

double reprojection_error(const Camera& camera, const Vec3d& point, const Vec2d& pixel) {
  const Vec3d p = camera.world_to_camera * point;
  if (!(p.z > 0)) return std::numeric_limits<double>::infinity();
  const Vec2d at = camera.project(p);
  return std::hypot(at.x - pixel.x, at.y - pixel.y);
}

#ifndef ALIGNGS_WITH_CERES

bool bundle_adjustment_available() { return false; }

BundleReport adjust_bundle(BundleProblem&, const BundleSettings&) {
  throw Error({ErrorKind::kFailed,
               "this program was built without Ceres",
               {},
               {},
               "install libceres-dev (scripts/setup.sh does) and build again"});
}

#else

bool bundle_adjustment_available() { return true; }

namespace {

constexpr int kPoseSize = 6;  // rotation vector, then shift of the centre, both relative to the prior pose

/// Point in the frame of a camera that left its prior pose by `pose`.
template <class T>
void to_camera(const Camera& prior, const T* pose, const T* point, T* out) {
  const Vec3d centre = prior.centre();
  const T from_centre[3] = {point[0] - centre.x - pose[3], point[1] - centre.y - pose[4],
                            point[2] - centre.z - pose[5]};
  const Mat3d& r = prior.world_to_camera.rotation;
  T turned[3];
  for (int row = 0; row < 3; ++row) {
    turned[row] = r(row, 0) * from_centre[0] + r(row, 1) * from_centre[1] + r(row, 2) * from_centre[2];
  }
  ceres::AngleAxisRotatePoint(pose, turned, out);
}

constexpr double kNearest = 1e-6;  // scene units; nearer points have no projection

struct Reprojection {
  const Camera& camera;
  Vec2d pixel;
  std::array<double, 3> whitening;  ///< of errors in pixels
  template <class T>
  bool operator()(const T* pose, const T* focal, const T* point, T* residual) const {
    T p[3];
    to_camera(camera, pose, point, p);
    if (p[2] < T(kNearest)) return false;
    const T factor = exp(focal[0]) / p[2];
    const T x = camera.fx * factor * p[0] + (camera.cx - pixel.x),
            y = camera.fy * factor * p[1] + (camera.cy - pixel.y);
    residual[0] = whitening[0] * x;
    residual[1] = whitening[1] * x + whitening[2] * y;
    return true;
  }
};

struct LogDepth {
  const Camera& camera;
  double log_prior, sigma;
  template <class T>
  bool operator()(const T* pose, const T* scale, const T* point, T* residual) const {
    T p[3];
    to_camera(camera, pose, point, p);
    if (p[2] < T(kNearest)) return false;
    residual[0] = (log(p[2]) - log_prior - scale[0]) / sigma;
    return true;
  }
};

struct StaysNearZero {
  double sigma;
  template <class T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = value[0] / sigma;
    return true;
  }
};

struct PosePrior {
  double rotation, centre;
  double offset[kPoseSize];  ///< distance of the pose from its anchor; rotations are small, so they add
  template <class T>
  bool operator()(const T* pose, T* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = (pose[i] + offset[i]) / rotation;
    for (int i = 3; i < kPoseSize; ++i) residual[i] = (pose[i] + offset[i]) / centre;
    return true;
  }
};

PosePrior* pose_prior(const Camera& now, const Camera& anchor, const BundleSettings& settings, double extent) {
  auto* prior = new PosePrior{settings.rotation * kRadiansPerDegree, settings.centre * extent, {}};
  const Mat3d turn = now.world_to_camera.rotation * transpose(anchor.world_to_camera.rotation);
  ceres::RotationMatrixToAngleAxis(ceres::RowMajorAdapter3x3(turn.m), prior->offset);
  const Vec3d shift = now.centre() - anchor.centre();
  for (int i = 0; i < 3; ++i) prior->offset[3 + i] = shift[i];
  return prior;
}

Camera moved(const Camera& prior, const double* pose, double focal) {
  Camera camera = prior;
  double rotation[9];
  ceres::AngleAxisToRotationMatrix(pose, ceres::RowMajorAdapter3x3(rotation));
  Mat3d turn;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) turn(i, j) = rotation[3 * i + j];
  }
  const Vec3d centre = prior.centre() + Vec3d{pose[3], pose[4], pose[5]};
  camera.world_to_camera.rotation = turn * prior.world_to_camera.rotation;
  camera.world_to_camera.translation = -(camera.world_to_camera.rotation * centre);
  camera.fx *= std::exp(focal);
  camera.fy *= std::exp(focal);
  return camera;
}

void measure(const BundleProblem& problem, double& rms, double& median) {
  std::vector<double> errors;
  double squares = 0;
  for (const Observation& o : problem.observations) {
    const double e = reprojection_error(problem.cameras[static_cast<size_t>(o.view)],
                                        problem.points[static_cast<size_t>(o.point)], o.pixel);
    if (!std::isfinite(e)) continue;
    errors.push_back(e);
    squares += e * e;
  }
  rms = errors.empty() ? 0 : std::sqrt(squares / static_cast<double>(errors.size()));
  median = median_of(std::move(errors));
}

/// Sigma of one depth factor of each view: all of a view's together weigh as much as its independent ones.
std::vector<double> depth_sigmas(const BundleProblem& problem, const BundleSettings& settings) {
  std::vector<double> counts(problem.cameras.size(), 0.0);
  for (const Observation& o : problem.observations) counts[static_cast<size_t>(o.view)] += o.prior_depth > 0;
  std::vector<double> out;
  for (const double count : counts)
    out.push_back(settings.depth * std::sqrt(std::max(1.0, count / settings.depth_independent)));
  return out;
}

}  // namespace

BundleReport adjust_bundle(BundleProblem& problem, const BundleSettings& settings) {
  BundleReport report;
  const size_t views = problem.cameras.size();
  problem.depth_scale.assign(views, 1.0);
  problem.focal_factor = 1;
  measure(problem, report.start_rms, report.start_median);
  report.end_rms = report.start_rms;
  report.end_median = report.start_median;
  const std::vector<Camera> prior = problem.cameras;
  std::vector<double> poses(views * kPoseSize, 0.0), scales(views, 0.0);
  double focal = 0;
  ceres::Problem ceres_problem;
  std::vector<bool> used(views, false);
  bool any = false;
  const std::vector<double> depth_sigma = depth_sigmas(problem, settings);
  for (const Observation& o : problem.observations) {
    const size_t v = static_cast<size_t>(o.view);
    double* point = &problem.points[static_cast<size_t>(o.point)].x;
    if (!((prior[v].world_to_camera * problem.points[static_cast<size_t>(o.point)]).z > kNearest)) continue;
    ceres_problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Reprojection, 2, kPoseSize, 1, 3>(
                                       new Reprojection{prior[v], o.pixel, whitening(o.covariance, settings.pixel)}),
                                   new ceres::CauchyLoss(1.0), &poses[v * kPoseSize], &focal, point);
    if (o.prior_depth > 0) {
      ceres_problem.AddResidualBlock(new ceres::AutoDiffCostFunction<LogDepth, 1, kPoseSize, 1, 3>(
                                         new LogDepth{prior[v], std::log(o.prior_depth), depth_sigma[v]}),
                                     new ceres::CauchyLoss(1.0), &poses[v * kPoseSize], &scales[v], point);
    }
    if (problem.fixed_points) ceres_problem.SetParameterBlockConstant(point);
    used[v] = any = true;
  }
  if (!any) return report;
  for (size_t v = 0; v < views; ++v) {
    if (!used[v]) continue;
    ceres_problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PosePrior, kPoseSize, kPoseSize>(
            pose_prior(prior[v], problem.anchors.empty() ? prior[v] : problem.anchors[v], settings, problem.extent)),
        nullptr, &poses[v * kPoseSize]);
    if (!problem.fixed.empty() && problem.fixed[v]) ceres_problem.SetParameterBlockConstant(&poses[v * kPoseSize]);
    if (ceres_problem.HasParameterBlock(&scales[v])) {
      ceres_problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<StaysNearZero, 1, 1>(new StaysNearZero{settings.depth_scale}), nullptr,
          &scales[v]);
    }
  }
  if (settings.focal > 0) {
    ceres_problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<StaysNearZero, 1, 1>(new StaysNearZero{settings.focal}), nullptr, &focal);
  } else {
    ceres_problem.SetParameterBlockConstant(&focal);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = problem.fixed_points ? ceres::DENSE_NORMAL_CHOLESKY : ceres::DENSE_SCHUR;
  options.max_num_iterations = settings.iterations;
  options.function_tolerance = settings.tolerance;
  options.num_threads = 1;  // the same bits for any number of threads
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  report.iterations = static_cast<int>(summary.iterations.size());
  report.converged = summary.IsSolutionUsable();
  if (!report.converged) return report;
  for (size_t v = 0; v < views; ++v) {
    problem.cameras[v] = moved(prior[v], &poses[v * kPoseSize], focal);
    problem.depth_scale[v] = std::exp(scales[v]);
  }
  problem.focal_factor = std::exp(focal);
  measure(problem, report.end_rms, report.end_median);
  return report;
}

#endif

}  // namespace aligngs
