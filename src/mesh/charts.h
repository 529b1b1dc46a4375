// Charts of a mesh before they are laid out: pieces that a projection shows without folds.
#pragma once

#include "mesh/chart_atlas.h"

namespace aligngs {

/// A chart on its plane. Coordinates are in units of the mesh.
struct FlatChart {
  std::vector<uint32_t> triangles;
  std::vector<std::array<std::array<double, 2>, 3>> corners;  ///< of its triangles, lowest coordinates 0
  Vec3d normal;                                               ///< unit
  double width = 0, height = 0;                               ///< of the box, at the angle of least area
};

/// Every triangle is in one chart. Two triangles of a chart never cover the same cell of a grid of `texel`.
std::vector<FlatChart> flat_charts(const TriangleMesh& mesh, const std::vector<uint32_t>& part, double texel,
                                   const AtlasSettings& settings);

/// Calls body(x, y, weights of the corners) for the centres of the cells of a grid of one that lie in a triangle, or
/// nearer to it than `margin`.
template <class Body>
void for_cells(const std::array<std::array<double, 2>, 3>& c, double margin, Body&& body);

}  // namespace aligngs

#include "mesh/charts-inl.h"
