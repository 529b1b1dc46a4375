#include "mesh/mesh_cleaning.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

/// Adds a square of the given side, two triangles, of the plane z = 0.
void add_square(TriangleMesh& mesh, float x, float side) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (const Vec3f v : {Vec3f{x, 0, 0}, Vec3f{x + side, 0, 0}, Vec3f{x + side, side, 0}, Vec3f{x, side, 0}}) {
    mesh.vertices.push_back(v);
    mesh.labels.push_back(static_cast<uint16_t>(first));
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

TEST(CleanMesh, RemovesComponentsBySizeAndKeepsTheOthers) {
  TriangleMesh mesh;
  add_square(mesh, 0, 0.01f);  // a speck before two large parts
  add_square(mesh, 1, 1);
  add_square(mesh, 5, 0.5f);
  const CleaningReport report = clean_mesh(mesh, {.min_area = 0.0025});
  EXPECT_EQ(report.components, 3u);
  EXPECT_EQ(report.removed_components, 1u);
  EXPECT_EQ(report.removed_vertices, 4u);
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.vertices[mesh.triangles[0][0]].x, 1);
  EXPECT_EQ(mesh.labels, (std::vector<uint16_t>{4, 4, 4, 4, 8, 8, 8, 8}));
}

TEST(CleanMesh, EachLimitCounts) {
  TriangleMesh original;
  add_square(original, 0, 1);
  for (const ComponentLimits& limits :
       {ComponentLimits{.min_area = 1.1}, ComponentLimits{.min_extent = 1.5}, ComponentLimits{.min_triangles = 3}}) {
    TriangleMesh mesh = original;
    clean_mesh(mesh, limits);
    EXPECT_TRUE(mesh.triangles.empty());
    EXPECT_TRUE(mesh.vertices.empty());
  }
  TriangleMesh mesh = original;
  clean_mesh(mesh, {.min_area = 0.9, .min_extent = 1.4, .min_triangles = 2});
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST(CleanMesh, RemovesDegenerateTrianglesAndUnusedVertices) {
  TriangleMesh mesh;
  add_square(mesh, 0, 1);
  mesh.vertices.push_back({NAN, 0, 0});
  mesh.vertices.push_back({2, 0, 0});
  mesh.labels.resize(6, 0);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, 5});  // on one line
  mesh.triangles.push_back({0, 1, 4});  // not a number
  const CleaningReport report = clean_mesh(mesh, {});
  EXPECT_EQ(report.degenerate_triangles, 3u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
}

TEST(CleanMesh, AVertexOutOfRangeIsRefused) {
  TriangleMesh mesh;
  add_square(mesh, 0, 1);
  mesh.triangles.push_back({0, 1, 9});
  EXPECT_THROW(clean_mesh(mesh, {}), Error);
}

}  // namespace
}  // namespace aligngs
