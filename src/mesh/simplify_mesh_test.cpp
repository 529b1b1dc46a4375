#include "mesh/simplify_mesh.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "core/error.h"
#include "mesh/close_mesh.h"
#include "mesh/testing/grid.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

/// A unit sphere of `rings` rings, closed, turned outward.
TriangleMesh sphere(uint32_t rings) {
  TriangleMesh mesh;
  const uint32_t columns = 2 * rings;
  for (uint32_t j = 0; j <= rings; ++j) {
    const double polar = M_PI * j / rings;
    const uint32_t count = j == 0 || j == rings ? 1 : columns;
    for (uint32_t i = 0; i < count; ++i) {
      const double a = 2 * M_PI * i / columns;
      mesh.vertices.push_back(
          {float(std::sin(polar) * std::cos(a)), float(std::sin(polar) * std::sin(a)), float(std::cos(polar))});
    }
  }
  const auto at = [&](uint32_t j, uint32_t i) {
    return j == 0       ? 0
           : j == rings ? static_cast<uint32_t>(mesh.vertices.size() - 1)
                        : 1 + (j - 1) * columns + i % columns;
  };
  for (uint32_t j = 0; j < rings; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      if (j > 0) mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j, i + 1)});
      if (j + 1 < rings) mesh.triangles.push_back({at(j, i + 1), at(j + 1, i), at(j + 1, i + 1)});
    }
  }
  return mesh;
}

/// A flat square of n x n cells in the plane z = 0.
TriangleMesh square(uint32_t n) {
  TriangleMesh mesh;
  for (uint32_t j = 0; j <= n; ++j) {
    for (uint32_t i = 0; i <= n; ++i) mesh.vertices.push_back({float(i) / float(n), float(j) / float(n), 0});
  }
  add_grid_triangles(mesh, n);
  return mesh;
}

/// The triangles whose middle satisfies a condition, and the others.
template <class Condition>
std::pair<TriangleMesh, TriangleMesh> parted(const TriangleMesh& mesh, Condition&& condition) {
  std::vector<uint8_t> one, other;
  for (const auto& t : mesh.triangles) {
    const Vec3f middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) * (1.f / 3);
    one.push_back(condition(middle));
    other.push_back(!one.back());
  }
  return {keep_triangles(mesh, one), keep_triangles(mesh, other)};
}

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh all = a;
  const uint32_t base = static_cast<uint32_t>(a.vertices.size());
  all.vertices.insert(all.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return all;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]].cast<double>();
    sum += 0.5 * norm(cross(mesh.vertices[t[1]].cast<double>() - a, mesh.vertices[t[2]].cast<double>() - a));
  }
  return sum;
}

TEST(SimplifyMesh, AFlatPartBecomesFewTriangles) {
  TriangleMesh mesh = square(40);
  const SimplifyReport report = simplify_parts({&mesh}, {.error = 0.001});
  EXPECT_EQ(report.before, 3200u);
  EXPECT_LE(report.after, 8u);
  EXPECT_NEAR(area(mesh), 1, 1e-4);
}

TEST(SimplifyMesh, ReachesTheNumberOfTriangles) {
  TriangleMesh mesh = sphere(40);
  const SimplifyReport report = simplify_parts({&mesh}, {.triangles = 500});
  EXPECT_LE(report.after, 500u);
  EXPECT_GE(report.after, 450u);
  EXPECT_EQ(mesh.triangles.size(), report.after);
  EXPECT_NEAR(area(mesh), 4 * M_PI, 0.2);
}

TEST(SimplifyMesh, StaysWithinTheError) {
  const TriangleMesh before = sphere(60);
  TriangleMesh mesh = before;
  const SimplifyReport report = simplify_parts({&mesh}, {.error = 0.01});
  EXPECT_LT(report.after, report.before / 4);
  EXPECT_LE(report.error, 0.01);
  const RayScene surface(mesh);
  for (const Vec3f& v : before.vertices) {
    const auto near = surface.nearest(v.cast<double>(), 0.5);
    ASSERT_TRUE(near.has_value());
    EXPECT_LT(near->distance, 0.02);
  }
}

TEST(SimplifyMesh, APartedSphereStaysClosed) {
  auto [north, south] = parted(sphere(40), [](const Vec3f& p) { return p.z > 0.3f + 0.2f * std::sin(5 * p.x); });
  ASSERT_EQ(open_edges(together(north, south)), 0u);
  simplify_parts({&north, &south}, {.triangles = 400});
  EXPECT_LE(north.triangles.size() + south.triangles.size(), 400u);
  EXPECT_EQ(open_edges(together(north, south)), 0u);
}

TEST(SimplifyMesh, TheBorderOfTwoFlatPartsStaysWhereItIs) {
  auto [left, right] = parted(square(40), [](const Vec3f& p) { return p.x < 0.5f; });
  simplify_parts({&left, &right}, {.error = 0.001});
  EXPECT_LE(left.triangles.size() + right.triangles.size(), 16u);
  EXPECT_NEAR(area(left), 0.5, 1e-4);
  EXPECT_NEAR(area(right), 0.5, 1e-4);
}

TEST(SimplifyMesh, VerticesKeepTheirAttributes) {
  TriangleMesh mesh = sphere(30);
  for (const Vec3f& v : mesh.vertices) {
    mesh.normals.push_back(v);
    mesh.colors.push_back({static_cast<uint8_t>(127 + 127 * v.x), static_cast<uint8_t>(127 + 127 * v.y), 7});
    mesh.labels.push_back(v.z > 0 ? 1 : 2);
  }
  simplify_parts({&mesh}, {.triangles = 200});
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_LT(norm(mesh.normals[v] - mesh.vertices[v]), 1e-6f);
    EXPECT_EQ(mesh.colors[v][0], static_cast<uint8_t>(127 + 127 * mesh.vertices[v].x));
    EXPECT_EQ(mesh.labels[v], mesh.vertices[v].z > 0 ? 1 : 2);
  }
}

TEST(SimplifyMesh, TilesThatShareNoVertexAreOneSurface) {
  const TriangleMesh shared = square(20);
  TriangleMesh tiles;
  for (const auto& t : shared.triangles) {
    const uint32_t base = static_cast<uint32_t>(tiles.vertices.size());
    for (const uint32_t v : t) tiles.vertices.push_back(shared.vertices[v]);
    tiles.triangles.push_back({base, base + 1, base + 2});
  }
  EXPECT_LE(simplify_parts({&tiles}, {.error = 0.001}).after, 8u);
}

TEST(SimplifyMesh, PlacesThatDifferInTheSignOfZeroAreOne) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, -0.0f, 0}, {1, 1, 0}, {-0.0f, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  simplify_parts({&mesh}, {.triangles = 2});
  EXPECT_THAT(mesh.vertices, testing::SizeIs(4));
}

TEST(SimplifyMesh, WithoutALimitIsAnError) {
  TriangleMesh mesh = square(2);
  EXPECT_THROW(simplify_parts({&mesh}, {}), Error);
}

TEST(SimplifyMesh, ASmallMeshStaysAsItIs) {
  TriangleMesh mesh = square(2);
  EXPECT_EQ(simplify_parts({&mesh}, {.triangles = 100}).after, 8u);
}

TEST(CloseMesh, TwoHolesOfASphereAreClosedOutward) {
  const TriangleMesh whole = sphere(40);
  TriangleMesh mesh = parted(whole, [](const Vec3f& p) { return p.z < 0.8f && p.x < 0.9f; }).first;
  ASSERT_GT(open_edges(mesh), 0u);
  const ClosingReport report = close_mesh(mesh);
  EXPECT_EQ(report.holes, 2u);
  EXPECT_EQ(report.open_edges, 0u);
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume += dot(mesh.vertices[t[0]].cast<double>(),
                  cross(mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>())) /
              6;
  EXPECT_GT(volume, 0.85 * 4 * M_PI / 3);
  EXPECT_LT(volume, 4 * M_PI / 3);
}

TEST(CloseMesh, AHoleThatIsNoStarIsClosedFlat) {
  // A horseshoe in a square: two legs and the bow between them.
  const auto [plate, horseshoe] = parted(square(40), [](const Vec3f& p) {
    const bool bow = p.y > 0.6f && p.y < 0.8f && p.x > 0.2f && p.x < 0.8f;
    const bool legs = p.y > 0.2f && p.y <= 0.6f && ((p.x > 0.2f && p.x < 0.3f) || (p.x > 0.7f && p.x < 0.8f));
    return !bow && !legs;
  });
  TriangleMesh mesh = plate;
  close_mesh(mesh);
  // The outer border is a hole, too: its filling is the other side of the square.
  EXPECT_EQ(open_edges(mesh), 0u);
  EXPECT_NEAR(area(mesh), 2, 1e-4) << "no filling covers what is there";
}

TEST(CloseMesh, AHoleWithoutEarsGetsAVertexInTheMiddle) {
  TriangleMesh mesh;  // a pyramid without its base
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 1}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (const auto& [a, c] : {std::pair{0u, 2u}, std::pair{1u, 3u}}) {  // both diagonals are edges of closed bodies
    const uint32_t q = static_cast<uint32_t>(mesh.vertices.size()), r = q + 1;
    mesh.vertices.push_back({0.3f, 0.6f, -1});
    mesh.vertices.push_back({0.8f, 0.4f, -2 - static_cast<float>(a)});
    for (const auto& t : {std::array{a, c, q}, std::array{c, a, r}, std::array{a, q, r}, std::array{q, c, r}})
      mesh.triangles.push_back(t);
  }
  mesh.vertices[5].x += 0.01f;
  mesh.colors.assign(mesh.vertices.size(), {10, 20, 30});
  ASSERT_EQ(open_edges(mesh), 4u);
  const ClosingReport report = close_mesh(mesh);
  EXPECT_EQ(report.open_edges, 0u);
  EXPECT_EQ(report.triangles, 4u);
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.colors.back()[2], 30);
  EXPECT_FLOAT_EQ(mesh.vertices.back().x, 0.5f);
}

TEST(CloseMesh, VerticesAtOnePlaceAreOne) {
  TriangleMesh mesh;  // a tetrahedron of loose triangles, one missing
  const Vec3f p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const auto& t : {std::array<int, 3>{0, 2, 1}, std::array<int, 3>{0, 1, 3}, std::array<int, 3>{1, 2, 3}}) {
    const uint32_t base = static_cast<uint32_t>(mesh.vertices.size());
    for (const int v : t) mesh.vertices.push_back(p[v]);
    mesh.triangles.push_back({base, base + 1, base + 2});
  }
  EXPECT_EQ(open_edges(mesh), 3u);
  EXPECT_EQ(close_mesh(mesh).open_edges, 0u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
}

TEST(CloseMesh, AFinGetsItsOtherSide) {
  TriangleMesh mesh = sphere(10);
  mesh.vertices.push_back({0, 0, 3});
  mesh.triangles.push_back({0, 1, static_cast<uint32_t>(mesh.vertices.size() - 1)});
  EXPECT_EQ(open_edges(mesh), 3u);
  EXPECT_EQ(close_mesh(mesh).open_edges, 0u);
}

}  // namespace
}  // namespace aligngs
