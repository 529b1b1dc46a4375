#include "scene/face_neighbours.h"

#include <algorithm>

namespace aligngs {

std::vector<std::array<uint32_t, 3>> face_neighbours(const TriangleMesh& mesh, CrowdedEdge crowded) {
  struct Side {
    uint32_t low, high, face, edge;
  };
  const size_t count = mesh.triangles.size();
  std::vector<Side> sides(3 * count);
  for (uint32_t f = 0; f < count; ++f) {
    for (uint32_t e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(mesh.triangles[f][e], mesh.triangles[f][(e + 1) % 3]);
      sides[3 * size_t(f) + e] = {low, high, f, e};
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::array{a.low, a.high, a.face, a.edge} < std::array{b.low, b.high, b.face, b.edge};
  });
  const auto is_same_edge = [](const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; };
  std::vector<std::array<uint32_t, 3>> out(count, {kNoFace, kNoFace, kNoFace});
  for (size_t i = 0, end = 0; i < sides.size(); i = end) {
    end = i + 1;
    while (end < sides.size() && is_same_edge(sides[i], sides[end])) ++end;
    const size_t faces = end - i;
    if (faces < 2 || (faces > 2 && crowded == CrowdedEdge::kJoinsNone)) continue;
    out[sides[i].face][sides[i].edge] = sides[i + 1].face;
    out[sides[i + 1].face][sides[i + 1].edge] = sides[i].face;
  }
  return out;
}

}  // namespace aligngs
