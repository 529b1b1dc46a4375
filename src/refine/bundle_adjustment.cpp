#include "refine/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/median.h"
#include "refine/bundle_system.h"

namespace aligngs {
namespace {

constexpr double kFirstRadius = 1e4;  // of the trust region: nearly a Gauss-Newton step
constexpr double kLeastGain = 1e-3;   // of what the linearised cost promises: a step with less is taken back
constexpr double kLeastRadius = 1e-32;

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

/// Levenberg-Marquardt with Nielsen's rule for the radius (Madsen, Nielsen, Tingleff 2004, 3.2).
BundleState minimise(const BundleSystem& system, const BundleSettings& settings, BundleReport& report) {
  BundleState at = system.start();
  double cost = system.cost(at), radius = kFirstRadius, shrink = 2;
  report.converged = std::isfinite(cost);
  while (report.converged && report.iterations < settings.iterations && radius > kLeastRadius) {
    ++report.iterations;
    const std::optional<BundleStep> step = system.step(at, radius);
    double gain = 0, tried_cost = cost;
    BundleState tried;
    if (step) {
      if (!(step->decrease > 0)) break;
      tried = system.moved(at, *step);
      tried_cost = system.cost(tried);
      gain = (cost - tried_cost) / step->decrease;
    }
    if (!(gain > kLeastGain)) {
      radius /= shrink;
      shrink *= 2;
      if (step && std::abs(cost - tried_cost) <= settings.tolerance * cost) break;
      continue;
    }
    radius /= std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3));
    shrink = 2;
    at = std::move(tried);
    const double gained = cost - tried_cost;
    cost = tried_cost;
    if (gained <= settings.tolerance * cost) break;
  }
  return at;
}

}  // namespace

double reprojection_error(const Camera& camera, const Vec3d& point, const Vec2d& pixel) {
  const Vec3d p = camera.world_to_camera * point;
  if (!(p.z > 0)) return std::numeric_limits<double>::infinity();
  const Vec2d at = camera.project(p);
  return std::hypot(at.x - pixel.x, at.y - pixel.y);
}

BundleReport adjust_bundle(BundleProblem& problem, const BundleSettings& settings, ThreadPool& pool) {
  BundleReport report;
  problem.depth_scale.assign(problem.cameras.size(), 1.0);
  problem.focal_factor = 1;
  measure(problem, report.start_rms, report.start_median);
  report.end_rms = report.start_rms;
  report.end_median = report.start_median;
  BundleState state;
  std::vector<size_t> views;
  {
    const BundleSystem system(problem, settings, pool);
    views = system.views();
    if (views.empty()) return report;
    state = minimise(system, settings, report);
  }
  if (!report.converged) return report;
  problem.focal_factor = std::exp(state.log_focal);
  for (Camera& camera : problem.cameras) {  // those of the others, too
    camera.fx *= problem.focal_factor;
    camera.fy *= problem.focal_factor;
  }
  for (size_t v = 0; v < views.size(); ++v) {
    problem.cameras[views[v]] = state.cameras[v];
    problem.depth_scale[views[v]] = std::exp(state.log_scales[v]);
  }
  problem.points = std::move(state.points);
  measure(problem, report.end_rms, report.end_median);
  return report;
}

}  // namespace aligngs
