// Fewer triangles for the same surface, by edge collapses of least quadric error (meshoptimizer; Garland and Heckbert
// 1997).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/triangle_mesh.h"

namespace aligngs {

/// Collapses stop at whichever limit is met first. At least one of them is above 0.
struct SimplifyLimits {
  size_t triangles = 0;  ///< to reach; 0: as few as the error allows
  double error = 0;      ///< units of the vertices, >= 0: how far the surface may move; 0: no limit
};

struct SimplifyReport {
  size_t before = 0, after = 0;  ///< triangles
  double error = 0;              ///< units of the vertices: largest quadric error of a collapse
};

/// Simplifies parts together that touch each other: pieces of one surface, cut along borders where the vertices of two
/// parts have the same place. A border is collapsed along itself only, on both sides at once, so that parts keep their
/// shapes and no gap opens. Places where three parts meet stay. Vertices of one part at the same place with nearly the
/// same normal become one. Those that are left keep their place and attributes; unused ones go. Error{kUsage} without a
/// limit.
SimplifyReport simplify_parts(const std::vector<TriangleMesh*>& parts, const SimplifyLimits& limits);

}  // namespace aligngs
