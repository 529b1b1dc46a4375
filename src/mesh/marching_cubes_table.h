// Edges of a cube that are joined to triangles, for each of the 256 patterns of inside and outside corners.
#pragma once

#include <array>
#include <cstdint>

namespace aligngs {

/// Corner c of the unit cube is at (c & 1, c >> 1 & 1, c >> 2 & 1).
/// Edge e runs along axis e / 4 from corner cube_edge_corner(e) to the corner one step further on that axis.
inline constexpr int kCubeEdges = 12;
int cube_edge_corner(int edge);

struct CubeCase {
  int triangles = 0;
  /// Edges of the triangles' vertices, three by three; counter-clockwise seen from the outside corners.
  std::array<uint8_t, 3 * 10> edges{};
};

/// Index: bit c is set when corner c is inside (negative). Two inside corners that face each other across a square are
/// kept apart; neighbouring cubes decide alike, so surfaces have no holes between cubes.
const std::array<CubeCase, 256>& marching_cubes_table();

}  // namespace aligngs
