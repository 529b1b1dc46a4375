// An indexed triangle mesh with optional per-vertex attributes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace aligngs {

/// "No label": used in label maps and on mesh vertices. Class 0 is a class.
inline constexpr uint16_t kNoLabel = 65535;

struct TriangleMesh {
  std::vector<Vec3f> vertices;                     ///< world, scene units
  std::vector<std::array<uint32_t, 3>> triangles;  ///< vertex indices, counter-clockwise seen from outside
  std::vector<Vec3f> normals;                      ///< per vertex, unit; empty when absent
  std::vector<std::array<uint8_t, 3>> colors;      ///< per vertex, sRGB; empty when absent
  std::vector<uint16_t> labels;                    ///< per vertex class or kNoLabel; empty when absent

  bool empty() const { return triangles.empty(); }
};

}  // namespace aligngs
