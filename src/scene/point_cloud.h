// A coloured point cloud, optionally with normals.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace aligngs {

struct PointCloud {
  std::vector<Vec3f> positions;  ///< world, scene units
  std::vector<Vec3f> colors;     ///< sRGB in [0, 1]; same length as positions
  std::vector<Vec3f> normals;    ///< unit, turned to the cameras that saw the point; empty when unknown

  size_t size() const { return positions.size(); }
  bool has_normals() const { return normals.size() == positions.size() && !positions.empty(); }
};

}  // namespace aligngs
