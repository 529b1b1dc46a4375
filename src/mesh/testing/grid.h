// Triangles over a grid of vertices, for the surfaces that tests make.
#pragma once

#include "scene/triangle_mesh.h"

namespace aligngs {

/// Adds two triangles for each cell of a grid of (n + 1) x (n + 1) vertices, row by row.
inline void add_grid_triangles(TriangleMesh& mesh, uint32_t n) {
  for (uint32_t j = 0; j < n; ++j) {
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({b, c + 1, c});
    }
  }
}

}  // namespace aligngs
