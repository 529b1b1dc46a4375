#include "gaussians/initialise.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/median.h"
#include "scene/kd_tree.h"
#include "scene/voxel_merge.h"

namespace aligngs {
namespace {

constexpr int kNeighbours = 3;
/// Scale of a Gaussian whose cloud has no extent at all (one point, or all points in one place); scene units.
constexpr float kLoneScale = 0.01f;
/// Duplicated points would get scale 0: none is smaller than this share of the cloud's median scale.
constexpr float kSmallestShare = 0.01f;
constexpr double kOpacityMargin = 1e-6;  ///< keeps the logit finite at opacity 0 and 1

/// sqrt of the mean squared distance to the (up to) 3 nearest other points; 0 for a lone point.
std::vector<float> neighbour_distances(const std::vector<Vec3f>& points) {
  const KdTree<float> tree(points);
  std::vector<float> out(points.size(), 0.0f);
  for (size_t i = 0; i < points.size(); ++i) {
    uint32_t index[kNeighbours + 1];
    float squared[kNeighbours + 1];
    const size_t found = tree.nearest(points[i], kNeighbours + 1, index, squared);
    // The point itself is one of them, at distance 0 (as is any duplicate): the first entry is that one.
    if (found < 2) continue;
    double sum = 0;
    for (size_t k = 1; k < found; ++k) sum += squared[k];
    out[i] = static_cast<float>(std::sqrt(sum / static_cast<double>(found - 1)));
  }
  return out;
}

float smallest_scale(std::vector<float> distances) {
  distances.erase(std::remove(distances.begin(), distances.end(), 0.0f), distances.end());
  if (distances.empty()) return kLoneScale;
  return kSmallestShare * median_of(std::move(distances));
}

void check(const PointCloud& cloud, const InitialiseOptions& options) {
  const auto fail = [](const char* field, const char* message) {
    throw Error({ErrorKind::kFailed, message, {}, field, {}});
  };
  if (cloud.colors.size() != cloud.size()) fail("colors", "one colour per point expected");
  if (options.semantic_channels < 0) fail("semantic_channels", "must not be negative");
  if (!(options.flat_ratio > 0 && options.flat_ratio <= 1)) fail("flat_ratio", "must lie in (0, 1]");
  if (!(options.scale_factor > 0)) fail("scale_factor", "must be positive");
  if (!(options.opacity >= 0 && options.opacity <= 1)) fail("opacity", "must lie in [0, 1]");
  for (const Vec3f& p : cloud.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) fail("positions", "a point is not finite");
  }
}

}  // namespace

GaussianModel initialise_gaussians(const PointCloud& cloud, const InitialiseOptions& options) {
  check(cloud, options);
  GaussianModel model;
  model.semantic_channels = options.semantic_channels;
  model.resize(cloud.size());
  if (cloud.size() == 0) return model;

  const std::vector<float> distances = neighbour_distances(cloud.positions);
  const float floor = smallest_scale(distances);
  const double opacity = std::clamp<double>(options.opacity, kOpacityMargin, 1 - kOpacityMargin);
  const float logit = static_cast<float>(std::log(opacity / (1 - opacity)));
  const bool oriented = options.use_normals && cloud.has_normals();
  for (size_t i = 0; i < cloud.size(); ++i) {
    float scale = std::max(distances[i], floor) * options.scale_factor;
    if (options.scale_max > 0) scale = std::min(scale, options.scale_max);
    const Vec3f normal = oriented ? normalized(cloud.normals[i]) : Vec3f{};
    const bool has_normal = dot(normal, normal) > 0.5f;  // 0 or 1 up to rounding; false for NaN
    const Quaternionf q = has_normal ? quaternion_from_z_to(normal) : Quaternionf{};
    const float thickness = has_normal ? scale * options.flat_ratio : scale;
    for (int k = 0; k < 3; ++k) {
      model.positions[3 * i + k] = cloud.positions[i][k];
      model.log_scales[3 * i + k] = std::log(k == 2 ? thickness : scale);
      model.sh[3 * kShCoefficients * i + k] = static_cast<float>((cloud.colors[i][k] - 0.5) / kSh0);
    }
    const float rotation[4] = {q.w, q.x, q.y, q.z};
    std::copy(rotation, rotation + 4, &model.rotations[4 * i]);
    model.opacity_logits[i] = logit;
  }
  return model;
}

PointCloud voxel_thin(const PointCloud& cloud, double edge) { return voxel_merge(cloud, edge).cloud; }

}  // namespace aligngs
