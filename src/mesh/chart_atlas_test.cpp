#include "mesh/chart_atlas.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "core/error.h"
#include "mesh/charts.h"
#include "mesh/testing/grid.h"

namespace aligngs {
namespace {

/// A bent sheet of n x n cells: a roll of two turns, whose projections fold over themselves.
TriangleMesh roll(uint32_t n) {
  TriangleMesh mesh;
  for (uint32_t j = 0; j <= n; ++j) {
    for (uint32_t i = 0; i <= n; ++i) {
      const double angle = 4 * M_PI * i / n, radius = 1 + 0.2 * angle;
      mesh.vertices.push_back({float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(2.0 * j / n)});
    }
  }
  add_grid_triangles(mesh, n);
  return mesh;
}

TriangleMesh rectangle() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Atlas atlas_of(const TriangleMesh& mesh, const AtlasSettings& settings) {
  return make_atlas(mesh, std::vector<uint32_t>(mesh.triangles.size(), 0), settings);
}

double edge(const Atlas& atlas, size_t t, size_t i, size_t j) {
  return std::hypot(atlas.corners[t][i][0] - atlas.corners[t][j][0], atlas.corners[t][i][1] - atlas.corners[t][j][1]) *
         atlas.texel;
}

TEST(ChartAtlas, AFlatPartIsOneChartOfItsOwnSize) {
  const Atlas atlas = atlas_of(rectangle(), {.texel = 0.01});
  ASSERT_EQ(atlas.charts.size(), 1u);
  EXPECT_NEAR(std::abs(atlas.charts[0].normal.z), 1, 1e-9);
  EXPECT_NEAR(atlas.charts[0].width, 201 + 4, 1) << "texels, with the gutter";
  EXPECT_NEAR(atlas.charts[0].height, 101 + 4, 1);
  EXPECT_NEAR(edge(atlas, 0, 0, 1), 2, 1e-4);
  EXPECT_NEAR(edge(atlas, 1, 1, 2), 2, 1e-4);
}

TEST(ChartAtlas, NoTexelIsCoveredTwice) {
  const TriangleMesh mesh = roll(60);
  const Atlas atlas = atlas_of(mesh, {.texel = 0.02});
  EXPECT_GT(atlas.charts.size(), 4u) << "two turns of a roll";
  std::map<std::pair<int, int>, size_t> owner;
  size_t covered = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<std::array<double, 2>, 3> corners;
    for (size_t i = 0; i < 3; ++i) corners[i] = {atlas.corners[t][i][0], atlas.corners[t][i][1]};
    const Chart& chart = atlas.charts[atlas.chart_of[t]];
    for_cells(corners, 0, [&](int x, int y, const std::array<double, 3>& w) {
      EXPECT_TRUE(x >= chart.x && y >= chart.y && x < chart.x + chart.width && y < chart.y + chart.height);
      if (w[0] < 1e-3 || w[1] < 1e-3 || w[2] < 1e-3) return;
      EXPECT_TRUE(owner.emplace(std::pair(x, y), t).second) << x << " " << y;
      ++covered;
    });
  }
  EXPECT_GT(covered, 10000u);
}

TEST(ChartAtlas, ChartsDoNotTouch) {
  const Atlas atlas = atlas_of(roll(60), {.texel = 0.05});
  for (size_t i = 0; i < atlas.charts.size(); ++i) {
    const Chart& a = atlas.charts[i];
    EXPECT_LE(a.x + a.width, atlas.width);
    EXPECT_LE(a.y + a.height, atlas.height);
    for (size_t j = 0; j < i; ++j) {
      const Chart& b = atlas.charts[j];
      EXPECT_TRUE(a.x >= b.x + b.width || b.x >= a.x + a.width || a.y >= b.y + b.height || b.y >= a.y + a.height);
    }
  }
}

TEST(ChartAtlas, NoEdgeShrinksBelowTheCosine) {
  const TriangleMesh mesh = roll(60);
  const Atlas atlas = atlas_of(mesh, {.texel = 0.02});
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (size_t i = 0; i < 3; ++i) {
      const size_t j = (i + 1) % 3;
      const double length =
          norm((mesh.vertices[mesh.triangles[t][i]] - mesh.vertices[mesh.triangles[t][j]]).cast<double>());
      EXPECT_GE(edge(atlas, t, i, j), 0.49 * length);
      EXPECT_LE(edge(atlas, t, i, j), 1.001 * length);
    }
  }
}

TEST(ChartAtlas, PartsHaveChartsOfTheirOwn) {
  const TriangleMesh mesh = rectangle();
  const Atlas atlas = make_atlas(mesh, {0, 1}, {.texel = 0.01});
  EXPECT_EQ(atlas.charts.size(), 2u);
  EXPECT_NE(atlas.chart_of[0], atlas.chart_of[1]);
}

TEST(ChartAtlas, TexelsGrowUntilTheChartsFit) {
  const Atlas atlas = atlas_of(roll(60), {.size = 256, .texel = 0.001});
  EXPECT_LE(atlas.width, 256);
  EXPECT_LE(atlas.height, 256);
  EXPECT_GT(atlas.texel, 0.01);
}

TEST(ChartAtlas, TooManyChartsForThePictureAreAnError) {
  TriangleMesh mesh;  // 10000 loose triangles, each with its gutter
  for (uint32_t i = 0; i < 10000; ++i) {
    const float x = 2.0f * static_cast<float>(i);
    for (const Vec3f& v : {Vec3f{x, 0, 0}, Vec3f{x + 1, 0, 0}, Vec3f{x, 1, 0}}) mesh.vertices.push_back(v);
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_THROW(atlas_of(mesh, {.size = 256, .texel = 0.1}), Error);
}

}  // namespace
}  // namespace aligngs
