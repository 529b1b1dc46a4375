#include "refine/pose_ransac.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "core/random.h"
#include "core/rotation_vector.h"
#include "refine/bundle_adjustment.h"

namespace aligngs {
namespace {

using Normal = Eigen::Matrix<double, 6, 6>;
using Step = Eigen::Matrix<double, 6, 1>;

constexpr size_t kSample = 3;        // matches that a pose has no freedom left after
constexpr int kIterations = 8;       // of Gauss-Newton: it doubles the digits each time, from some degrees off
constexpr double kConverged = 0.01;  // pixels, that a step moves the worst of a sample at most at the end

/// J'J and J'r of the reprojection of `match` when the camera's frame is turned and shifted; false behind the camera.
bool add_match(const Camera& camera, const PointMatch& match, Normal& normal, Step& gradient) {
  const Vec3d p = camera.world_to_camera * match.point;
  if (!(p.z > 1e-6)) return false;
  const Vec2d at = camera.project(p);
  const double u = camera.fx / p.z, v = camera.fy / p.z, x = p.x / p.z, y = p.y / p.z;
  Eigen::Matrix<double, 2, 6> jacobian;  // of the turn, then of the shift: d p = turn x p + shift
  jacobian << -u * x * p.y, u * (p.z + x * p.x), -u * p.y, u, 0, -u * x, -v * (p.z + y * p.y), v * y * p.x, v * p.x, 0,
      v, -v * y;
  const Eigen::Vector2d residual(at.x - match.pixel.x, at.y - match.pixel.y);
  normal += jacobian.transpose() * jacobian;
  gradient += jacobian.transpose() * residual;
  return true;
}

Camera moved(Camera camera, const Step& step) {
  const Rigidd motion{rotation_of({step[0], step[1], step[2]}), {step[3], step[4], step[5]}};
  camera.world_to_camera = motion * camera.world_to_camera;
  return camera;
}

/// Nothing where the matches have no pose near by: a point falls behind the camera, or the steps do not end.
template <class Indices>
std::optional<Camera> fit(Camera camera, const std::vector<PointMatch>& matches, const Indices& chosen) {
  double last = 0;
  for (int i = 0; i < kIterations; ++i) {
    Normal normal = Normal::Zero();
    Step gradient = Step::Zero();
    for (const size_t k : chosen) {
      if (!add_match(camera, matches[k], normal, gradient)) return {};
    }
    normal.diagonal() *= 1 + 1e-9;  // three points on a line leave a turn about it open
    const Step step = -normal.ldlt().solve(gradient);
    if (!step.allFinite() || step.head<3>().norm() > 1) return {};
    camera = moved(camera, step);
    last = step.head<3>().norm() * camera.fx;
  }
  if (!(last < kConverged)) return {};
  return camera;
}

std::vector<size_t> agreeing_with(const Camera& camera, const std::vector<PointMatch>& matches, double agreement) {
  std::vector<size_t> out;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (reprojection_error(camera, matches[i].point, matches[i].pixel) < agreement) out.push_back(i);
  }
  return out;
}

/// Three different ones.
std::array<size_t, kSample> draw(Random& random, size_t count) {
  std::array<size_t, kSample> out{};
  for (size_t k = 0; k < kSample; ++k) {
    do {
      out[k] = static_cast<size_t>(random.below(static_cast<int>(count)));
    } while (std::find(out.begin(), out.begin() + static_cast<long>(k), out[k]) != out.begin() + static_cast<long>(k));
  }
  return out;
}

}  // namespace

std::optional<RansacPose> ransac_pose(const Camera& start, const std::vector<PointMatch>& matches,
                                      const PoseSearchSettings& settings) {
  if (matches.size() <= kSample) return {};
  const auto near_start = [&](const Camera& c) {
    return rotation_angle_between_degrees(c.world_to_camera.rotation, start.world_to_camera.rotation) <=
           settings.largest_turn;
  };
  Random random(settings.seed);
  Camera best = start;
  std::vector<size_t> agreeing;
  for (int sample = 0; sample < settings.samples; ++sample) {
    const auto pose = fit(start, matches, draw(random, matches.size()));
    if (!pose || !near_start(*pose)) continue;
    std::vector<size_t> own = agreeing_with(*pose, matches, settings.agreement);
    if (own.size() <= agreeing.size()) continue;
    best = *pose;
    agreeing = std::move(own);
  }
  if (agreeing.size() <= kSample) return {};
  if (const auto refitted = fit(best, matches, agreeing); refitted && near_start(*refitted)) {
    const std::vector<size_t> again = agreeing_with(*refitted, matches, settings.agreement);
    if (again.size() >= agreeing.size()) return RansacPose{*refitted, static_cast<int>(again.size())};
  }
  return RansacPose{best, static_cast<int>(agreeing.size())};
}

}  // namespace aligngs
