#include "mesh/hole_filling.h"

#include <gtest/gtest.h>

#include <functional>

namespace aligngs {
namespace {

constexpr int kCells = 20;      // along a side
constexpr float kCell = 0.05f;  // metres
constexpr float kDistance = 2;  // metres from the camera

/// A wall of 1 x 1 m that faces the camera at the origin, without the cells that `open(i, j)` names.
TriangleMesh wall(const std::function<bool(int, int)>& open) {
  TriangleMesh mesh;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      mesh.vertices.push_back({kCell * float(i) - 0.5f, kCell * float(j) - 0.5f, kDistance});
      mesh.normals.push_back({0, 0, -1});
      mesh.colors.push_back({static_cast<uint8_t>(10 * i), 0, 0});
    }
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      if (open(i, j)) continue;
      const auto a = static_cast<uint32_t>(j * (kCells + 1) + i), b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  }
  return mesh;
}

struct Eye {
  Camera camera;
  ImageF depth;
  explicit Eye(float z) {
    camera.width = camera.height = 100;
    camera.fx = camera.fy = 100;
    camera.cx = camera.cy = 50;
    depth = ImageF(100, 100, 1, z);
  }
  HoleWitness witness() const { return {&camera, &depth}; }
};

bool middle_cell(int i, int j) { return i == 10 && j == 10; }

TEST(FillHoles, AHoleThatAViewSeesAsSurfaceIsClosed) {
  TriangleMesh mesh = wall(middle_cell);
  const size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  const Eye eye(kDistance);
  const HoleFillingReport report = close_seen_borders(mesh, {eye.witness()});
  EXPECT_EQ(report.filled, 1u);
  EXPECT_EQ(report.borders, 2u) << "the wall's own edge is one";
  ASSERT_EQ(mesh.vertices.size(), vertices + 1);
  EXPECT_EQ(mesh.triangles.size(), triangles + 4);
  EXPECT_NEAR(mesh.vertices.back().x, 0.025, 1e-6);
  EXPECT_NEAR(mesh.normals.back().z, -1, 1e-6) << "oriented as the mesh is";
  EXPECT_EQ(mesh.colors.back()[0], 105);
}

TEST(FillHoles, AHoleThatViewsLookThroughStays) {
  TriangleMesh mesh = wall(middle_cell);
  const Eye through(kDistance + 1), surface(kDistance);
  EXPECT_EQ(close_seen_borders(mesh, {through.witness(), surface.witness()}).filled, 0u)
      << "one says surface and one says hole";
  EXPECT_EQ(close_seen_borders(mesh, {surface.witness(), surface.witness(), through.witness()}).filled, 1u);
}

TEST(FillHoles, WhatNoViewSawStaysOpen) {
  TriangleMesh mesh = wall(middle_cell);
  const Eye hidden(kDistance - 1), nothing(0);
  EXPECT_EQ(close_seen_borders(mesh, {hidden.witness(), nothing.witness()}).filled, 0u);
  EXPECT_EQ(close_seen_borders(mesh, {}).filled, 0u);
}

TEST(FillHoles, LargeHolesStay) {
  TriangleMesh mesh = wall([](int i, int j) { return i >= 8 && i < 12 && j >= 8 && j < 12; });
  const Eye eye(kDistance);
  EXPECT_EQ(close_seen_borders(mesh, {eye.witness()}).filled, 0u) << "20 cm, diagonal 28";
  HoleFillingOptions larger;
  larger.max_size = 0.3;
  EXPECT_EQ(close_seen_borders(mesh, {eye.witness()}, larger).filled, 1u);
}

TEST(FillHoles, AHoleThatIsNotStarShapedStays) {
  TriangleMesh mesh =
      wall([](int i, int j) { return (j == 10 && i >= 8 && i <= 10) || (i == 8 && j >= 8 && j <= 10); });
  const Eye eye(kDistance);
  HoleFillingOptions larger;
  larger.max_size = 0.3;
  EXPECT_EQ(close_seen_borders(mesh, {eye.witness()}, larger).filled, 0u);
}

TEST(FillHoles, HolesThatShareACornerAndNoHolesAtAllChangeNothing) {
  TriangleMesh touching = wall([](int i, int j) { return (i == 10 && j == 10) || (i == 11 && j == 11); }),
               whole = wall([](int, int) { return false; });
  const Eye eye(kDistance);
  EXPECT_EQ(close_seen_borders(touching, {eye.witness()}).filled, 0u);
  EXPECT_EQ(close_seen_borders(whole, {eye.witness()}).filled, 0u);
  TriangleMesh nothing;
  EXPECT_EQ(close_seen_borders(nothing, {eye.witness()}).borders, 0u);
}

}  // namespace
}  // namespace aligngs
