#include "scene/depth_cloud.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/is_depth.h"
#include "core/median.h"
#include "scene/depth_normals.h"
#include "scene/voxel_merge.h"

namespace aligngs {
namespace {

void check_view(const DepthCloudView& view) {
  const auto fail = [](const char* field) {
    throw Error({ErrorKind::kFailed, "a map must have the size of its camera", {}, field, {}});
  };
  const auto has_size = [&](const ImageF& map, int channels) {
    return map.width == view.camera.width && map.height == view.camera.height && map.channels == channels;
  };
  if (!view.depth || !has_size(*view.depth, 1)) fail("depth");
  if (!view.color || !has_size(*view.color, 3)) fail("color");
  if (view.confidence && !has_size(*view.confidence, 1)) fail("confidence");
}

/// Whether a direct neighbour lies more than `jump` away: the pixel may mix two surfaces.
bool at_silhouette(const ImageF& depth, int x, int y, double jump) {
  const float z = depth.at(x, y);
  const int dx[4] = {-1, 1, 0, 0}, dy[4] = {0, 0, -1, 1};
  for (int k = 0; k < 4; ++k) {
    const int i = x + dx[k], j = y + dy[k];
    if (i < 0 || j < 0 || i >= depth.width || j >= depth.height || !is_depth(depth.at(i, j))) continue;
    if (std::abs(depth.at(i, j) - z) > jump * std::min(z, depth.at(i, j))) return true;
  }
  return false;
}

enum class Verdict { kNothing, kAgrees, kSeesThrough };

/// Evidence of one view about a world point. The best match among the four pixels around its projection counts. On a
/// slanted surface the nearest pixel alone may be off by half a footprint. The point is seen through only when all
/// valid ones of the four lie farther away.
Verdict judge(const DepthCloudView& view, const Vec3d& world, const DepthCloudOptions& options) {
  const Vec3d p = view.camera.world_to_camera * world;
  if (!(p.z > 0)) return Verdict::kNothing;
  const Vec2d pixel = view.camera.project(p);
  if (!view.camera.contains(pixel)) return Verdict::kNothing;
  const ImageF& depth = *view.depth;
  const int x0 = static_cast<int>(std::floor(pixel.x - 0.5)), y0 = static_cast<int>(std::floor(pixel.y - 0.5));
  bool agrees = false, any = false, all_farther = true;
  for (int k = 0; k < 4; ++k) {
    const int x = std::clamp(x0 + (k & 1), 0, depth.width - 1), y = std::clamp(y0 + (k >> 1), 0, depth.height - 1);
    const float z = depth.at(x, y);
    if (!is_depth(z)) continue;
    any = true;
    agrees |= std::abs(z - p.z) <= options.agreement * p.z;
    all_farther &= z > p.z * (1 + options.contradiction);
  }
  if (agrees) return Verdict::kAgrees;
  return any && all_farther ? Verdict::kSeesThrough : Verdict::kNothing;
}

/// The points of one view that survive the checks.
struct Contribution {
  PointCloud cloud;
  std::vector<float> weights;
  std::vector<uint8_t> views;
};

Contribution points_of_view(const std::vector<DepthCloudView>& views, size_t own, const DepthCloudOptions& options) {
  const DepthCloudView& view = views[own];
  const ImageF normals = camera_normals(*view.depth, view.camera);
  const Rigidd camera_to_world = view.camera.world_to_camera.inverse();
  const int stride = std::max(1, options.stride);
  Contribution out;
  for (int y = stride / 2; y < view.camera.height; y += stride) {
    for (int x = stride / 2; x < view.camera.width; x += stride) {
      const float z = view.depth->at(x, y);
      const float* n = normals.pixel(x, y);
      const float confidence = view.confidence ? view.confidence->at(x, y) : 1.0f;
      if (!is_depth(z) || !(confidence >= options.min_confidence) || !(confidence > 0)) continue;
      if (n[0] == 0 && n[1] == 0 && n[2] == 0) continue;  // no plane fit: an isolated or torn pixel
      if (at_silhouette(*view.depth, x, y, options.jump)) continue;
      const Vec3d world = camera_to_world * (view.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(z));
      int agreeing = 1;
      bool contradicted = false;
      for (size_t k = 0; k < views.size(); ++k) {
        if (k == own) continue;
        const Verdict verdict = judge(views[k], world, options);
        agreeing += verdict == Verdict::kAgrees;
        contradicted |= verdict == Verdict::kSeesThrough;
      }
      const bool confirmed = agreeing >= options.min_views;
      if (!confirmed && (!options.keep_single_view || contradicted)) continue;
      const float* rgb = view.color->pixel(x, y);
      out.cloud.positions.push_back(world.cast<float>());
      out.cloud.colors.push_back({rgb[0], rgb[1], rgb[2]});
      out.cloud.normals.push_back((camera_to_world.rotation * Vec3d{n[0], n[1], n[2]}).cast<float>());
      out.weights.push_back(confidence * static_cast<float>(confirmed ? 1.0 : options.single_view_weight));
      out.views.push_back(static_cast<uint8_t>(std::min(agreeing, 255)));
    }
  }
  return out;
}

void append(Contribution&& part, Contribution& all) {
  const auto join = [](auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  join(part.cloud.positions, all.cloud.positions);
  join(part.cloud.colors, all.cloud.colors);
  join(part.cloud.normals, all.cloud.normals);
  join(part.weights, all.weights);
  join(part.views, all.views);
  part = {};
}

}  // namespace

double median_pixel_footprint(const std::vector<DepthCloudView>& views) {
  std::vector<float> footprints;
  for (const DepthCloudView& view : views) {
    std::vector<float> depths;
    for (float z : view.depth->data) {
      if (is_depth(z)) depths.push_back(z);
    }
    if (!depths.empty()) footprints.push_back(static_cast<float>(median_of(std::move(depths)) / view.camera.fx));
  }
  return median_of(std::move(footprints));
}

DepthCloud fuse_depth_cloud(const std::vector<DepthCloudView>& views, const DepthCloudOptions& options,
                            ThreadPool& pool) {
  for (const DepthCloudView& view : views) check_view(view);
  std::vector<Contribution> parts(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) parts[i] = points_of_view(views, i, options);
  });
  Contribution all;
  for (Contribution& part : parts) append(std::move(part), all);

  DepthCloud out;
  const bool automatic = !(options.voxel > 0);
  out.voxel = automatic ? options.voxel_footprints * median_pixel_footprint(views) : options.voxel;
  VoxelMerge merged = voxel_merge(all.cloud, out.voxel, all.weights);
  while (automatic && options.max_points > 0 && out.voxel > 0 && merged.cloud.size() > options.max_points) {
    // Cubes on a surface: their number falls with the square of the edge. 2 % more, so that one or two rounds do.
    const double excess = static_cast<double>(merged.cloud.size()) / static_cast<double>(options.max_points);
    out.voxel *= 1.02 * std::sqrt(excess);
    merged = voxel_merge(all.cloud, out.voxel, all.weights);
  }
  out.cloud = std::move(merged.cloud);
  out.weights = std::move(merged.weights);
  out.views.assign(out.cloud.size(), 1);
  for (size_t i = 0; i < merged.cell_of.size(); ++i) {
    if (merged.cell_of[i] == VoxelMerge::kDropped) continue;
    uint8_t& count = out.views[merged.cell_of[i]];
    count = std::max(count, all.views[i]);
  }
  return out;
}

}  // namespace aligngs
