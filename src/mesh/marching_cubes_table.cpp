#include "mesh/marching_cubes_table.h"

namespace aligngs {
namespace {

int edge_between(int a, int b) {
  const int difference = a ^ b, low = a & b;  // the corners differ in one bit: the axis
  for (int e = 0; e < kCubeEdges; ++e) {
    if (cube_edge_corner(e) == low && 1 << (e / 4) == difference) return e;
  }
  return -1;
}

/// The corners of a face, counter-clockwise seen from outside the cube.
std::array<int, 4> face_corners(int axis, int side) {
  const int b = 1 << ((axis + 1) % 3), c = 1 << ((axis + 2) % 3), base = side << axis;
  if (side) return {base, base | b, base | b | c, base | c};
  return {base, base | c, base | b | c, base | b};
}

CubeCase build_case(int inside) {
  const auto is_inside = [inside](int corner) { return (inside >> corner & 1) != 0; };
  // On each face a segment cuts every run of inside corners off. Walking around the face, the run lies between the edge
  // where inside begins and the edge where it ends. The surface, which looks away from the inside, passes the segment
  // in that direction.
  std::array<int, kCubeEdges> next;
  next.fill(-1);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const std::array<int, 4> corner = face_corners(axis, side);
      for (int k = 0; k < 4; ++k) {
        if (is_inside(corner[k]) || !is_inside(corner[(k + 1) % 4])) continue;
        int end = k + 1;
        while (is_inside(corner[(end + 1) % 4])) ++end;
        const int begins = edge_between(corner[k], corner[(k + 1) % 4]);
        next[begins] = edge_between(corner[end % 4], corner[(end + 1) % 4]);
      }
    }
  }
  // Each crossed edge begins a segment on one of its faces and ends one on the other: the segments are closed loops.
  CubeCase result;
  std::array<bool, kCubeEdges> used{};
  for (int first = 0; first < kCubeEdges; ++first) {
    if (next[first] < 0 || used[first]) continue;
    used[first] = true;
    int previous = next[first];
    used[previous] = true;
    for (int e = next[previous]; e != first; previous = e, e = next[e]) {
      used[e] = true;
      const int at = 3 * result.triangles++;
      result.edges[at] = static_cast<uint8_t>(first);
      result.edges[at + 1] = static_cast<uint8_t>(previous);
      result.edges[at + 2] = static_cast<uint8_t>(e);
    }
  }
  return result;
}

}  // namespace

int cube_edge_corner(int edge) {
  // The four corners whose bit of the edge's axis is clear.
  const int axis = edge / 4, b = 1 << ((axis + 1) % 3), c = 1 << ((axis + 2) % 3);
  return (edge & 1 ? b : 0) | (edge & 2 ? c : 0);
}

const std::array<CubeCase, 256>& marching_cubes_table() {
  static const std::array<CubeCase, 256> table = [] {
    std::array<CubeCase, 256> t;
    for (int i = 0; i < 256; ++i) t[i] = build_case(i);
    return t;
  }();
  return table;
}

}  // namespace aligngs
