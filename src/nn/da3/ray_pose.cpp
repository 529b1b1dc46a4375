#include "nn/da3/ray_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/random.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kValues = 7;   // of a ray
constexpr size_t kSample = 8;    // rays of a draw
constexpr double kNearby = 0.2;  // of a direction, to agree
using Homography = Eigen::Matrix3d;

[[noreturn]] void refuse(const std::string& message) {
  throw_bad_input({}, "rays", message, "use the cameras of the decoder instead");
}

/// A pixel in [-1, 1]^2, the direction it should have as (x / z, y / z), and how much it counts.
struct Ray {
  double x, y, u, v, weight;
};

std::vector<Ray> rays_of(const FeatureMap& map) {
  constexpr double kLeastZ = 1e-4;  // a direction beyond counts nothing
  std::vector<Ray> rays;
  rays.reserve(size_t(map.places()));
  for (int64_t i = 0; i < map.height; ++i) {
    for (int64_t j = 0; j < map.width; ++j) {
      const float* const r = map.at(i, j);
      const double z = double(r[2]);
      const bool finite = std::all_of(r, r + kValues, [](float v) { return std::isfinite(v); });
      const bool counts = finite && std::abs(z) > kLeastZ;
      rays.push_back({double(2 * j + 1) / double(map.width) - 1, double(2 * i + 1) / double(map.height) - 1,
                      counts ? double(r[0]) / z : 0.0, counts ? double(r[1]) / z : 0.0,
                      counts ? double(r[kValues - 1]) : 0.0});
    }
  }
  return rays;
}

/// Direct linear transform: the smallest eigenvector of the normal equations, rows weighted. Scaled to A(2, 2) = 1.
Homography fit_homography(const std::vector<Ray>& rays, const std::vector<size_t>& chosen) {
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const size_t i : chosen) {
    const Ray& r = rays[i];
    Eigen::Matrix<double, 9, 1> a, b;
    a << -r.x, -r.y, -1, 0, 0, 0, r.x * r.u, r.y * r.u, r.u;
    b << 0, 0, 0, -r.x, -r.y, -1, r.x * r.v, r.y * r.v, r.v;
    normal += r.weight * (a * a.transpose() + b * b.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Homography a;
  a << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
  return a / a(2, 2);
}

/// Rays whose direction the homography meets, not counting those that are not numbers.
std::vector<size_t> inliers_of(const std::vector<Ray>& rays, const Homography& a) {
  std::vector<size_t> near;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Ray& r = rays[i];
    const Eigen::Vector3d p = a * Eigen::Vector3d(r.x, r.y, 1);
    if (std::hypot(p.x() / p.z() - r.u, p.y() / p.z() - r.v) < kNearby) near.push_back(i);
  }
  return near;
}

struct Triangular {
  Homography rotation, factor;
};

/// A = rotation * factor, factor triangular with a positive diagonal and 1 in the last place.
Triangular take_apart(const Homography& a, RayDecomposition how) {
  Homography reversal = Homography::Identity();
  if (how == RayDecomposition::kPublished) reversal = Homography::Identity().rowwise().reverse();
  const Eigen::HouseholderQR<Homography> qr(a * reversal);
  Triangular out;
  out.rotation = Homography(qr.householderQ()) * reversal;
  out.factor = reversal * Homography(qr.matrixQR().triangularView<Eigen::Upper>()) * reversal;
  for (int i = 0; i < 3; ++i) {
    if (out.factor(i, i) >= 0) continue;
    out.rotation.col(i) *= -1;
    out.factor.row(i) *= -1;
  }
  const double last = out.factor(2, 2);
  if (!(last > 0) || !(out.factor(0, 0) > 0) || !(out.factor(1, 1) > 0) || !out.factor.allFinite())
    refuse("their homography is singular");
  out.factor /= last;
  return out;
}

void set_intrinsics(NetworkCamera& camera, const Homography& f, RayDecomposition how, double width, double height) {
  camera.fx = width / 2 / f(0, 0);
  camera.fy = height / 2 / f(1, 1);
  if (how == RayDecomposition::kPublished) {
    camera.cx = (f(2, 0) + 1) * width / 2;
    camera.cy = (f(2, 1) + 1) * height / 2;
    return;
  }
  // f is the inverse of [[a, s, c], [0, b, d], [0, 0, 1]] in canonical pixels: c and d by substitution.
  const double d = -f(1, 2) / f(1, 1), c = -(f(0, 2) + f(0, 1) * d) / f(0, 0);
  camera.cx = (1 + c) * width / 2;
  camera.cy = (1 + d) * height / 2;
}

/// The centre of the camera: the mean of the rays' origins.
Eigen::Vector3d mean_origin(const FeatureMap& map, const std::vector<Ray>& rays) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (!(rays[i].weight > 0)) continue;
    const float* const origin = map.data.data() + int64_t(i) * kValues + 3;
    sum += rays[i].weight * Eigen::Vector3d(double(origin[0]), double(origin[1]), double(origin[2]));
    total += rays[i].weight;
  }
  if (!(total > 0)) refuse("no ray has a direction");
  return sum / total;
}

}  // namespace

int64_t ray_candidates(int64_t rays) {
  constexpr double kShare = 0.3;
  return std::min(rays, std::max(int64_t(kSample), int64_t(double(rays) * kShare)));
}

RayDraws draw_rays(int64_t rays, const RayPoseOptions& options) {
  const int candidates = int(ray_candidates(rays));
  if (candidates < int(kSample)) refuse("there are " + std::to_string(rays) + " of them, 8 are needed");
  Random random(options.seed);
  RayDraws draws(size_t(std::max(options.draws, 1)));
  for (auto& draw : draws) {
    for (size_t k = 0; k < kSample;) {
      const int next = random.below(candidates);
      if (std::find(draw.begin(), draw.begin() + k, next) == draw.begin() + k) draw[k++] = next;
    }
  }
  return draws;
}

RayPose pose_from_rays(const FeatureMap& map, const RayDraws& draws, int64_t width, int64_t height,
                       const RayPoseOptions& options) {
  if (map.channels != kValues || map.places() < int64_t(kSample)) refuse("there are too few of them");
  const std::vector<Ray> rays = rays_of(map);
  std::vector<size_t> sorted(rays.size());
  std::iota(sorted.begin(), sorted.end(), size_t(0));
  std::stable_sort(sorted.begin(), sorted.end(), [&](size_t a, size_t b) { return rays[a].weight > rays[b].weight; });

  double best_score = -1;
  std::vector<size_t> best;
  for (const auto& draw : draws) {
    std::vector<size_t> chosen;
    for (const int position : draw) chosen.push_back(sorted.at(size_t(position)));
    std::vector<size_t> near = inliers_of(rays, fit_homography(rays, chosen));
    double score = 0;
    for (const size_t i : near) score += rays[i].weight;
    if (score <= best_score) continue;
    best_score = score;
    best = std::move(near);
  }
  if (best.size() < kSample) refuse("hardly any agree with each other");

  RayPose out;
  out.inliers = best.size();
  Homography a = fit_homography(rays, best);
  if (a.determinant() < 0) a = -a;
  const Triangular parts = take_apart(a, options.decomposition);
  const Eigen::Vector3d centre = mean_origin(map, rays);
  const Eigen::Vector3d translation = -parts.rotation.transpose() * centre;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out.camera.rotation[size_t(3 * i + j)] = parts.rotation(j, i);  // inverse of camera-to-world
      out.homography[size_t(3 * i + j)] = a(i, j);
    }
    out.camera.translation[size_t(i)] = translation(i);
  }
  set_intrinsics(out.camera, parts.factor, options.decomposition, double(width), double(height));
  return out;
}

RayPose pose_from_rays(const FeatureMap& rays, int64_t width, int64_t height, const RayPoseOptions& options) {
  return pose_from_rays(rays, draw_rays(rays.places(), options), width, height, options);
}

}  // namespace aligngs::nn
