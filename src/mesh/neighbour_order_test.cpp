#include "mesh/neighbour_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>

namespace aligngs {
namespace {

/// A square of n x n fields in the plane z = 0, with its triangles in a random order, and a vertex that nobody uses.
TriangleMesh shuffled_square(uint32_t n) {
  TriangleMesh mesh;
  for (uint32_t y = 0; y <= n; ++y) {
    for (uint32_t x = 0; x <= n; ++x) {
      mesh.vertices.push_back({float(x), float(y), 0});
      mesh.colors.push_back({uint8_t(x), uint8_t(y), 7});
      mesh.labels.push_back(uint16_t(x + 100 * y));
    }
  }
  for (uint32_t y = 0; y < n; ++y) {
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({b, d, c});
    }
  }
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(1));
  mesh.vertices.push_back({99, 99, 99});
  mesh.colors.push_back({1, 1, 1});
  mesh.labels.push_back(9);
  return mesh;
}

using Corner = std::array<float, 2>;

/// Places of the triangles, each from its least corner on in its own direction.
std::multiset<std::array<Corner, 3>> places(const TriangleMesh& mesh) {
  std::multiset<std::array<Corner, 3>> out;
  for (const auto& t : mesh.triangles) {
    std::array<Corner, 3> corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = {mesh.vertices[t[k]].x, mesh.vertices[t[k]].y};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.insert(corners);
  }
  return out;
}

TEST(NeighbourOrder, TheSurfaceStaysTheSame) {
  const TriangleMesh before = shuffled_square(12);
  TriangleMesh after = before;
  order_by_neighbours(after);
  EXPECT_EQ(places(after), places(before));
  EXPECT_EQ(after.vertices.size(), before.vertices.size() - 1) << "what nobody uses goes";
  for (size_t i = 0; i < after.vertices.size(); ++i) {
    const int x = static_cast<int>(after.vertices[i].x), y = static_cast<int>(after.vertices[i].y);
    ASSERT_EQ(after.colors[i][0], x);
    ASSERT_EQ(after.labels[i], x + 100 * y);
  }
}

TEST(NeighbourOrder, VerticesAreNumberedByFirstUse) {
  TriangleMesh mesh = shuffled_square(12);
  order_by_neighbours(mesh);
  uint32_t next = 0;
  for (const auto& t : mesh.triangles) {
    for (const uint32_t v : t) {
      ASSERT_LE(v, next);
      next = std::max(next, v + 1);
    }
  }
}

TEST(NeighbourOrder, AnEmptyMeshStaysEmpty) {
  TriangleMesh mesh;
  order_by_neighbours(mesh);
  EXPECT_TRUE(mesh.empty());
}

}  // namespace
}  // namespace aligngs
