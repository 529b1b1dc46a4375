// Checks of a scene by cameras and points alone: the geometric part of scene_check.h.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/median.h"
#include "scene/scene_check.h"

namespace aligngs {
namespace {

constexpr int kGrid = 24;         ///< cells across the image of the coarse depth test
constexpr double kBehind = 1.1;   ///< a point this much farther than the nearest one of its cell is hidden
constexpr int kMinEvidence = 30;  ///< points needed to call a map disparity
constexpr double kDisparityRank = -0.5;
constexpr double kOtherUnit = 3;          ///< ratio: feet are 3.3 to a metre, and no prior in scene units is so far off
constexpr size_t kMinCloud = 100;         ///< points; below, what single views see tells nothing
constexpr size_t kFewPoints = 20;         ///< points in a view: too few to place it or its Gaussians
constexpr double kSmallOverlap = 0.1;     ///< share of a view's points that its best neighbour sees
constexpr double kSmallBaseline = 0.005;  ///< of the robust extent: below, two cameras see no parallax

/// Ranks 1..n, equal values sharing their mean rank.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] < values[b]; });
  std::vector<double> out(values.size());
  for (size_t begin = 0; begin < order.size();) {
    size_t end = begin;
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (size_t k = begin; k < end; ++k) out[order[k]] = (static_cast<double>(begin + end) + 1) / 2;
    begin = end;
  }
  return out;
}

/// Pearson's correlation; 0 when one side is constant.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

void check_overlap(const Scene& scene, std::vector<SceneProblem>& problems) {
  std::vector<std::vector<uint32_t>> seen;
  for (int view : scene.train) seen.push_back(visible_points(scene.cloud, scene.views[view].camera));
  for (size_t i = 0; i < seen.size(); ++i) {
    const View& view = scene.views[scene.train[i]];
    if (seen[i].size() < kFewPoints) {
      problems.push_back(
          {view.image, "points",
           fmt::format("only {} of the cloud's {} points lie in this view", seen[i].size(), scene.cloud.size()),
           "check its pose, or leave the view out", false});
      continue;
    }
    size_t best = 0;
    std::vector<uint32_t> common;
    for (size_t k = 0; k < seen.size(); ++k) {
      if (k == i) continue;
      common.clear();
      std::set_intersection(seen[i].begin(), seen[i].end(), seen[k].begin(), seen[k].end(), std::back_inserter(common));
      best = std::max(best, common.size());
    }
    const double share = static_cast<double>(best) / static_cast<double>(seen[i].size());
    if (seen.size() > 1 && share < kSmallOverlap) {
      problems.push_back(
          {view.image, "overlap",
           fmt::format("no other training view sees more than {:.0f} % of what this one sees", 100 * share),
           "add views between this one and the others, or leave it out", false});
    }
  }
}

void check_baselines(const Scene& scene, std::vector<SceneProblem>& problems) {
  const double limit = kSmallBaseline * robust_extent(scene);
  double largest = 0;
  const Vec3d first = scene.views[scene.train[0]].camera.centre();
  for (int i : scene.train) largest = std::max(largest, norm(scene.views[i].camera.centre() - first));
  if (scene.train.size() > 1 && largest < limit) {
    problems.push_back({scene.folder, "poses", "all training cameras are in one place, so nothing can be triangulated",
                        "take photos from different places", false});
  }
}

void check_count(const Scene& scene, std::vector<SceneProblem>& problems) {
  if (scene.train.size() >= kFewestTrainingViews) return;
  problems.push_back({scene.folder / "split.json", "train",
                      "only one view trains: it has no parallax, so nothing but priors says how far away things are",
                      "add photos of the same things from other places", false});
}

/// A part of a larger photo may have its principal point outside. More often the camera is for another size.
void check_principal_points(const Scene& scene, std::vector<SceneProblem>& problems) {
  for (const int i : scene.train) {
    const View& view = scene.views[i];
    const Camera& c = view.camera;
    const bool corner = c.cx <= 1 && c.cy <= 1;  // parts of the width and height instead of pixels
    if (!corner && c.cx > 0 && c.cy > 0 && c.cx < c.width && c.cy < c.height) continue;
    problems.push_back({view.image, "camera",
                        fmt::format("the principal point ({:.4g}, {:.4g}) lies {} of this photo of {} x {}", c.cx, c.cy,
                                    corner ? "in the corner" : "outside", c.width, c.height),
                        "check that the camera is for photos of this size, and in pixels", false});
  }
}

/// Positions are kept in float, whose steps grow with the distance from the origin.
void check_place(const Scene& scene, std::vector<SceneProblem>& problems) {
  constexpr double kFar = 100;  // extents from the origin: float steps reach a hundred thousandth of the extent
  const double extent = robust_extent(scene);
  double farthest = 0;
  for (const int i : scene.train) farthest = std::max(farthest, norm(scene.views[i].camera.centre()));
  if (scene.train.size() < 2 || farthest < kFar * extent) return;
  problems.push_back({scene.folder / "sparse", "poses",
                      fmt::format("the cameras lie {:.4g} from the origin, {:.0f} times the scene's extent of {:.4g}: "
                                  "positions lose precision",
                                  farthest, farthest / extent, extent),
                      "`aligngs import` moves the scene to its origin in double precision and keeps the way back",
                      false});
}

}  // namespace

std::vector<uint32_t> visible_points(const PointCloud& cloud, const Camera& camera) {
  struct Projection {
    uint32_t point;
    int cell;
    float z;
  };
  const Mat3d& rotation = camera.world_to_camera.rotation;
  std::vector<Projection> inside;
  std::vector<float> nearest(kGrid * kGrid, 0.0f);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Vec3d p = rotation * cloud.positions[i].cast<double>() + camera.world_to_camera.translation;
    if (!(p.z > 0)) continue;
    const Vec2d pixel = camera.project(p);
    if (!camera.contains(pixel)) continue;
    const int cx = static_cast<int>(pixel.x * kGrid / camera.width),
              cy = static_cast<int>(pixel.y * kGrid / camera.height);
    const int cell = std::min(cy, kGrid - 1) * kGrid + std::min(cx, kGrid - 1);
    const float z = static_cast<float>(p.z);
    if (nearest[cell] == 0 || z < nearest[cell]) nearest[cell] = z;
    inside.push_back({static_cast<uint32_t>(i), cell, z});
  }
  std::vector<uint32_t> out;
  for (const Projection& p : inside) {
    if (p.z <= kBehind * nearest[p.cell]) out.push_back(p.point);
  }
  return out;
}

bool DisparityEvidence::is_enough() const { return points >= kMinEvidence; }

bool DisparityEvidence::is_disparity() const { return is_enough() && rank_correlation < kDisparityRank; }

bool DisparityEvidence::has_other_unit() const { return ratio > kOtherUnit || ratio < 1 / kOtherUnit; }

DisparityEvidence disparity_evidence(const PointCloud& cloud, const Camera& camera, const ImageF& prior_depth) {
  const Camera at_map = camera.resized(prior_depth.width, prior_depth.height);
  std::vector<double> depths, priors;
  for (uint32_t i : visible_points(cloud, at_map)) {
    const Vec3d p = at_map.world_to_camera * cloud.positions[i].cast<double>();
    const Vec2d pixel = at_map.project(p);
    const float prior = prior_depth.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
    if (!(std::isfinite(prior) && prior > 0)) continue;
    depths.push_back(p.z);
    priors.push_back(prior);
  }
  DisparityEvidence evidence;
  evidence.points = static_cast<int>(depths.size());
  if (!evidence.is_enough()) return evidence;
  evidence.rank_correlation = correlation(ranks(depths), ranks(priors));
  std::vector<double> ratios(depths.size());
  for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = priors[i] / depths[i];
  evidence.ratio = median_of(std::move(ratios));
  return evidence;
}

std::vector<SceneProblem> check_geometry(const Scene& scene) {
  std::vector<SceneProblem> problems;
  if (scene.train.empty()) return problems;
  if (scene.cloud.size() >= kMinCloud) {
    check_overlap(scene, problems);
  } else {
    const std::string what = scene.cloud.size() == 0
                                 ? "there are no points to start from"
                                 : fmt::format("the cloud has only {} points to start from", scene.cloud.size());
    problems.push_back({scene.folder / "sparse", "points3D", what, "give the scene SfM points or prior depth", false});
  }
  check_count(scene, problems);
  check_baselines(scene, problems);
  check_place(scene, problems);
  check_principal_points(scene, problems);
  return problems;
}

}  // namespace aligngs
