// One voxel, and what one view does to it: the arithmetic that the CPU and devices share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/rigid.h"

namespace aligngs {

inline constexpr int kBlockSide = 8;  // voxels
inline constexpr int kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;

struct Voxel {
  float tsdf = 1;                   ///< signed distance / truncation in [-1, 1]; positive in front of the surface
  float weight = 0;                 ///< 0: never observed
  std::array<uint16_t, 3> color{};  ///< mean sRGB, 65535 = 1
  uint16_t color_weight = 0;        ///< in units of kColorWeightUnit, saturating; 0: no colour
};
inline constexpr float kColorWeightUnit = 1.0f / 1024;

/// Integer coordinates of a block, in units of kBlockSide voxels.
struct BlockCoordinate {
  int x = 0, y = 0, z = 0;
};

/// A view as its blocks and voxels need it. The maps are of `width` x `height`.
struct VoxelView {
  const float* depth = nullptr;   ///< <= 0 or non-finite: no value
  const float* color = nullptr;   ///< three per pixel, or null
  const float* weight = nullptr;  ///< 0: the pixel is not used at all
  const float* slope = nullptr;   ///< -n . r of the surface's unit normal and the ray with z = 1, or null: 1
  int width = 0, height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  float truncation = 0;
  float behind = 1e30f;  ///< scene units along the ray behind the surface that it tells anything about
  bool observed_only = false, carve = true;

  double voxel = 0;  ///< scene units
  Rigidd world_to_camera;
  Vec3d planes[4];                  ///< through the camera centre and the image borders, normals pointing inwards
  double radius = 0;                ///< of a block
  double farthest = 0;              ///< a block whose centre is farther away sees nothing of this view
  Vec3f along_x, along_y, along_z;  ///< steps of a voxel in the camera frame

  /// Whether any voxel of the block can lie in the image and not behind everything.
  ALIGNGS_HD bool sees(const BlockCoordinate& at) const {
    const double block = voxel * kBlockSide;
    const Vec3d centre = world_to_camera * Vec3d{(at.x + 0.5) * block, (at.y + 0.5) * block, (at.z + 0.5) * block};
    if (centre.z < -radius || centre.z > farthest) return false;
    bool inside = true;
    for (const Vec3d& plane : planes) inside = inside && dot(plane, centre) > -radius;
    return inside;
  }
  /// Centre of the block's first voxel in the camera frame.
  ALIGNGS_HD Vec3f origin(const BlockCoordinate& at) const {
    const Vec3d p{(at.x * kBlockSide + 0.5) * voxel, (at.y * kBlockSide + 0.5) * voxel,
                  (at.z * kBlockSide + 0.5) * voxel};
    return (world_to_camera * p).cast<float>();
  }
  ALIGNGS_HD Vec3f row(const Vec3f& block_origin, int j, int k) const {
    return block_origin + along_y * static_cast<float>(j) + along_z * static_cast<float>(k);
  }

  /// Depth of a pixel, or 0 where it has no value.
  ALIGNGS_HD float depth_at(int x, int y) const {
    const float d = depth[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
    return d > 0 && d < 1e30f ? d : 0.0f;  // NaN compares false, infinity is excluded
  }
  /// Depth at image point (u, v) in pixel (x, y): bilinear where the four pixels around it belong to one surface, else
  /// the nearest pixel's. A depth that differs by more than the truncation is another surface.
  ALIGNGS_HD float sample_depth(float u, float v, int x, int y) const {
    const float nearest = depth_at(x, y);
    if (nearest == 0) return 0;
    const float gx = u - 0.5f, gy = v - 0.5f;
    const int x0 = static_cast<int>(std::floor(gx)), y0 = static_cast<int>(std::floor(gy));
    if (x0 < 0 || y0 < 0 || x0 + 1 >= width || y0 + 1 >= height) return nearest;
    const float a = depth_at(x0, y0), b = depth_at(x0 + 1, y0);
    const float c = depth_at(x0, y0 + 1), d = depth_at(x0 + 1, y0 + 1);
    const float low = std::min(std::min(a, b), std::min(c, d)), high = std::max(std::max(a, b), std::max(c, d));
    if (low == 0 || high - low > truncation) return nearest;
    const float s = gx - static_cast<float>(x0), t = gy - static_cast<float>(y0);
    return (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t;
  }
};

ALIGNGS_HD inline void add_color(Voxel& voxel, const float* rgb, float weight) {
  const float units = std::min(std::max(weight / kColorWeightUnit, 1.0f), 65535.0f);
  const float total = std::min(static_cast<float>(voxel.color_weight) + units, 65535.0f);
  const float share = units / total;
  for (size_t c = 0; c < 3; ++c) {
    const float value = rgb[c] > 0 ? std::min(rgb[c], 1.0f) * 65535.0f : 0.0f;
    const float mean = static_cast<float>(voxel.color[c]);
    const float mixed = std::min(std::max(mean + (value - mean) * share, 0.0f), 65535.0f);
    voxel.color[c] = static_cast<uint16_t>(std::lround(mixed));
  }
  voxel.color_weight = static_cast<uint16_t>(total);
}

/// The view's weighted mean into the voxel at `p` of the camera frame.
ALIGNGS_HD inline void fuse_voxel(const VoxelView& view, const Vec3f& p, Voxel& voxel) {
  if (!(p.z > 0)) return;
  const float inverse = 1 / p.z;
  const float u = view.fx * p.x * inverse + view.cx, v = view.fy * p.y * inverse + view.cy;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(view.width) && v < static_cast<float>(view.height))) return;
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x);
  const float weight = view.weight[pixel];
  if (!(weight > 0) || (view.observed_only && voxel.weight == 0)) return;
  const float depth = view.sample_depth(u, v, x, y);
  // With a normal, the distance from the surface's tangent plane: along the ray, surface seen at an angle would seem
  // farther away.
  const float distance = view.slope != nullptr ? (depth - p.z) * view.slope[pixel] : depth - p.z;
  if (depth == 0 || distance < -view.truncation || p.z - depth > view.behind) return;
  const bool near = distance <= view.truncation;
  if (!near && !view.carve) return;
  const float total = voxel.weight + weight;
  const float value = near ? distance / view.truncation : 1.0f;
  voxel.tsdf += (value - voxel.tsdf) * (weight / total);
  voxel.weight = total;
  if (near && view.color != nullptr) add_color(voxel, view.color + 3 * pixel, weight);
}

}  // namespace aligngs
