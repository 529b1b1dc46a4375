#include "metrics/mesh_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "metrics/point_index.h"
#include "metrics/surface_points.h"

namespace aligngs {
namespace {

/// A square of side 1 in the plane z = height.
TriangleMesh unit_square(float height) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, height}, {1, 0, height}, {1, 1, height}, {0, 1, height}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(SampleSurface, IsUniformInArea) {
  TriangleMesh mesh = unit_square(0);
  // A second square, four times as large, beside it.
  for (const Vec3f v : {Vec3f{2, 0, 0}, Vec3f{4, 0, 0}, Vec3f{4, 2, 0}, Vec3f{2, 2, 0}}) mesh.vertices.push_back(v);
  mesh.triangles.push_back({4, 5, 6});
  mesh.triangles.push_back({4, 6, 7});
  const SurfaceSamples samples = sample_surface(mesh, {.points_per_area = 1000});
  EXPECT_NEAR(samples.area, 5, 1e-9);
  ASSERT_EQ(samples.positions.size(), 5000u);
  int small = 0, lower_left = 0;
  for (const Vec3f& p : samples.positions) {
    small += p.x < 1.5f;
    lower_left += p.x > 2 && p.x < 3 && p.y < 1;
  }
  EXPECT_EQ(small, 1000);             // stratified: exact up to rounding
  EXPECT_NEAR(lower_left, 1000, 90);  // 3 sigma of a binomial
  EXPECT_NEAR(samples.normals[0].z, 1, 1e-6);
}

TEST(SampleSurface, TheCapHoldsAndTheSeedRepeats) {
  const TriangleMesh mesh = unit_square(0);
  const SurfaceSamples a = sample_surface(mesh, {.points_per_area = 1e4, .max_points = 100, .seed = 7});
  const SurfaceSamples b = sample_surface(mesh, {.points_per_area = 1e4, .max_points = 100, .seed = 7});
  EXPECT_TRUE(a.capped);
  ASSERT_EQ(a.positions.size(), 100u);
  for (size_t i = 0; i < 100; ++i) EXPECT_EQ(a.positions[i].x, b.positions[i].x);
}

TEST(SampleSurface, DegenerateTrianglesGetNoPoints) {
  TriangleMesh mesh = unit_square(0);
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.triangles = {{0, 0, 1}, {0, 1, 4}};
  EXPECT_TRUE(sample_surface(mesh).positions.empty());
}

TEST(Thinning, LeavesTheMeanOfEachVoxel) {
  const std::vector<Vec3f> points = {{0, 0, 0}, {0.004f, 0, 0}, {1, 0, 0}, {NAN, 0, 0}};
  const std::vector<Vec3f> thinned = thin_to_voxels(points, 0.02);
  ASSERT_EQ(thinned.size(), 2u);
  EXPECT_NEAR(thinned[0].x, 0.002, 1e-7);
  EXPECT_EQ(thinned[1].x, 1);
}

TEST(Thinning, RefusesAVoxelThatIsTooSmallOrNotPositive) {
  EXPECT_THROW(thin_to_voxels({{0, 0, 0}, {1e6f, 0, 0}}, 0.01), Error);
  EXPECT_THROW(thin_to_voxels({{0, 0, 0}}, 0), Error);
  EXPECT_TRUE(thin_to_voxels({}, 0.02).empty());
}

TEST(Thinning, TheMajorityLabelStands) {
  const std::vector<Vec3f> points(5, Vec3f{0, 0, 0});
  EXPECT_EQ(thin_labelled(points, {3, 1, 1, kNoLabel, 2}, 0.02).labels, std::vector<uint16_t>{1});
  EXPECT_EQ(thin_labelled(points, {9, 4, 9, 4, kNoLabel}, 0.02).labels, std::vector<uint16_t>{4});
}

TEST(PointIndex, FindsTheNearestAndSaysNothingForNothing) {
  const PointIndex index({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
  EXPECT_EQ(index.nearest({0.9f, 0.1f, 0}).index, 1u);
  EXPECT_NEAR(index.nearest({0, 4, 0}).distance, 2, 1e-6);
  EXPECT_EQ(index.nearest({NAN, 0, 0}).index, Nearest::kNoPoint);
  EXPECT_EQ(PointIndex({}).nearest({0, 0, 0}).index, Nearest::kNoPoint);
}

PointSet sampled(const TriangleMesh& mesh) {
  const SurfaceSamples s = sample_surface(mesh);
  return {s.positions, s.normals};
}

TEST(ComparePoints, AShiftBelowTheThresholdIsPerfect) {
  ThreadPool pool(2);
  const MeshScores scores = compare_points(sampled(unit_square(0.03f)), sampled(unit_square(0)), pool);
  EXPECT_EQ(scores.fscore, 1);
  EXPECT_NEAR(scores.accuracy, 0.03, 1e-3);  // a little more: the samples do not face each other exactly
  EXPECT_NEAR(scores.completeness, 0.03, 1e-3);
  EXPECT_NEAR(scores.normal_consistency, 1, 1e-6);
}

TEST(ComparePoints, AShiftAboveTheThresholdIsWorthless) {
  ThreadPool pool(2);
  const MeshScores scores = compare_points(sampled(unit_square(0.07f)), sampled(unit_square(0)), pool);
  EXPECT_EQ(scores.fscore, 0);
  EXPECT_NEAR(scores.accuracy, 0.07, 1e-3);
}

TEST(ComparePoints, StrictExcludesTheThresholdItself) {
  ThreadPool pool(1);
  const PointSet a{{{0, 0, 0}}, {}}, b{{{0, 0, 0.5f}}, {}};
  EXPECT_EQ(compare_points(a, b, pool, {0.5, true}).fscore, 0);
  EXPECT_EQ(compare_points(a, b, pool, {0.5, false}).fscore, 1);
}

TEST(ComparePoints, HalfAPlaneHasHalfTheRecall) {
  ThreadPool pool(2);
  TriangleMesh half = unit_square(0);
  for (Vec3f& v : half.vertices) v.x *= 0.5f;
  const MeshScores scores = compare_points(sampled(half), sampled(unit_square(0)), pool);
  EXPECT_EQ(scores.precision, 1);
  EXPECT_NEAR(scores.recall, 0.55, 0.01);  // half, and 5 cm beyond its edge
  EXPECT_NEAR(scores.fscore, 2 * scores.recall / (1 + scores.recall), 1e-12);
}

TEST(ComparePoints, EmptySetsHaveDefinedScores) {
  ThreadPool pool(1);
  const PointSet empty, one{{{0, 0, 0}}, {}};
  const MeshScores nothing_predicted = compare_points(empty, one, pool);
  EXPECT_EQ(nothing_predicted.fscore, 0);
  EXPECT_EQ(nothing_predicted.recall, 0);
  EXPECT_TRUE(std::isnan(nothing_predicted.precision));
  EXPECT_TRUE(std::isnan(nothing_predicted.accuracy));
  EXPECT_TRUE(std::isnan(compare_points(one, empty, pool).fscore));
}

}  // namespace
}  // namespace aligngs
