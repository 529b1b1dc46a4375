// Thinning of point clouds: one point per occupied cube.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/point_cloud.h"

namespace aligngs {

/// The merged cloud and which of its points each input point went into.
struct VoxelMerge {
  PointCloud cloud;               ///< weighted mean position and colour; normals (when given) summed and normalised
  std::vector<float> weights;     ///< sum of the weights of a cube's points
  std::vector<uint32_t> cell_of;  ///< per input point: index into cloud, or kDropped
  static constexpr uint32_t kDropped = 0xffffffffu;  ///< a point that is not finite, or of weight zero
};

/// Merges the points of each cube of edge `edge` (scene units) of a grid through the origin. `weights` is empty
/// (all 1) or has one entry >= 0 per point. Cubes come out in order of their first point, so the result does not
/// depend on anything but the input. An edge that is not positive merges nothing and only drops invalid points.
VoxelMerge voxel_merge(const PointCloud& cloud, double edge, const std::vector<float>& weights = {});

}  // namespace aligngs
