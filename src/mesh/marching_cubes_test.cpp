#include "mesh/marching_cubes.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/random.h"
#include "mesh/marching_cubes_table.h"
#include "mesh/testing/analytic_scenes.h"

namespace aligngs {
namespace {

TEST(MarchingCubesTable, UsesExactlyTheCrossedEdges) {
  for (int inside = 0; inside < 256; ++inside) {
    std::set<int> crossed, used;
    for (int e = 0; e < kCubeEdges; ++e) {
      const int a = cube_edge_corner(e), b = a | 1 << (e / 4);
      if ((inside >> a & 1) != (inside >> b & 1)) crossed.insert(e);
    }
    const CubeCase& cube = marching_cubes_table()[inside];
    for (int i = 0; i < 3 * cube.triangles; ++i) used.insert(cube.edges[i]);
    EXPECT_EQ(used, crossed) << inside;
  }
}

TEST(MarchingCubesTable, ACutCornerFacesAwayFromTheInside) {
  const CubeCase& cube = marching_cubes_table()[1];  // corner (0, 0, 0) inside
  ASSERT_EQ(cube.triangles, 1);
  Vec3d p[3];
  for (int i = 0; i < 3; ++i) p[i][cube.edges[i] / 4] = 0.5;  // the three edges at that corner
  EXPECT_GT(dot(cross(p[1] - p[0], p[2] - p[0]), Vec3d{1, 1, 1}), 0);
}

TEST(MarchingCubesTable, RandomFieldsGiveClosedSurfaces) {
  // A lattice of 6^3 random signs with a border outside. On a closed surface, each edge of a triangle is walked as
  // often in one direction as in the other.
  constexpr int kSide = 6;
  Random random(1);
  bool inside[kSide][kSide][kSide] = {};
  for (int z = 1; z < kSide - 1; ++z)
    for (int y = 1; y < kSide - 1; ++y)
      for (int x = 1; x < kSide - 1; ++x) inside[z][y][x] = random.chance(0.5);
  std::map<std::pair<int, int>, int> walked;
  for (int z = 0; z + 1 < kSide; ++z)
    for (int y = 0; y + 1 < kSide; ++y)
      for (int x = 0; x + 1 < kSide; ++x) {
        int pattern = 0;
        for (int c = 0; c < 8; ++c) pattern |= inside[z + (c >> 2)][y + (c >> 1 & 1)][x + (c & 1)] << c;
        const CubeCase& cube = marching_cubes_table()[pattern];
        const auto vertex = [&](int i) {
          const int c = cube_edge_corner(cube.edges[i]);
          const int point = ((z + (c >> 2)) * kSide + y + (c >> 1 & 1)) * kSide + x + (c & 1);
          return 3 * point + cube.edges[i] / 4;
        };
        for (int t = 0; t < cube.triangles; ++t) {
          for (int k = 0; k < 3; ++k) ++walked[{vertex(3 * t + k), vertex(3 * t + (k + 1) % 3)}];
        }
      }
  ASSERT_GT(walked.size(), 300u);
  for (const auto& [edge, times] : walked) {
    const auto back = walked.find({edge.second, edge.first});
    ASSERT_NE(back, walked.end());
    EXPECT_EQ(back->second, times);
  }
}

TEST(ExtractSurface, AnEmptyVolumeHasNoSurface) {
  TsdfVolume volume({});
  volume.allocate();
  ThreadPool pool(1);
  EXPECT_TRUE(extract_surface(volume, pool).empty());
}

TEST(ExtractSurface, VerticesAreSharedAcrossBlocks) {
  const auto frames = test::ball_views(0.5);
  ThreadPool pool(2);
  TsdfVolume volume({.voxel = 0.02, .truncation = 0.08});
  const ImageF weight(160, 160, 1, 1.0f);
  std::vector<TsdfView> views;
  for (const FusionFrame& f : frames) views.push_back({&f.camera, &f.depth, nullptr, &weight});
  for (const TsdfView& v : views) volume.reserve(v, pool);
  volume.allocate();
  for (const TsdfView& v : views) volume.integrate(v, pool);
  const TriangleMesh mesh = extract_surface(volume, pool);
  // Closed and of the topology of a ball: V - E + F = 2 with E = 3 F / 2.
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second);
  }
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.count({b, a}));
  EXPECT_EQ(static_cast<long>(mesh.vertices.size()) - static_cast<long>(mesh.triangles.size()) / 2, 2);
}

}  // namespace
}  // namespace aligngs
