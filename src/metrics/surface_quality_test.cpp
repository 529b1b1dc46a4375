#include "metrics/surface_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/random.h"
#include "metrics/camera_hits.h"

namespace aligngs {
namespace {

constexpr int kCells = 40;      // along a side of the wall
constexpr float kHalf = 1;      // metres: half a side
constexpr float kDistance = 2;  // metres from the cameras

/// A wall of 2 x 2 m before the cameras, `kCells` x `kCells` squares of two triangles. `depth(x, y)` is in metres.
/// Cells that `missing(i, j)` names are left out.
TriangleMesh relief(const std::function<float(float, float)>& depth,
                    const std::function<bool(int, int)>& missing = {}) {
  TriangleMesh mesh;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const float x = kHalf * (2.0f * float(i) / kCells - 1), y = kHalf * (2.0f * float(j) / kCells - 1);
      mesh.vertices.push_back({x, y, depth(x, y)});
    }
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      if (missing && missing(i, j)) continue;
      const auto a = static_cast<uint32_t>(j * (kCells + 1) + i), b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  }
  return mesh;
}

float flat(float, float) { return kDistance; }

constexpr float kFold = 0.1f;  // slope of the folds

/// Ridges and grooves along y, each face a cell wide.
float folds(float x, float) {
  const float cell = 2 * kHalf / kCells;
  return kDistance + (std::lround((x + kHalf) / cell) % 2 ? kFold * cell : 0);
}

/// Looks along z from x, and sees all of the wall and more.
Camera camera_at(double x) {
  Camera camera;
  camera.width = camera.height = 320;
  camera.fx = camera.fy = 240;
  camera.cx = camera.cy = 160;
  camera.world_to_camera.translation = {-x, 0, 0};
  return camera;
}

class SurfaceQualityTest : public testing::Test {
 protected:
  SurfaceQuality measure(const TriangleMesh& predicted, const TriangleMesh& truth) {
    const RayScene predicted_rays(predicted), truth_rays(truth);
    SurfaceQualityInput input;
    input.predicted = &predicted;
    input.truth = &truth;
    input.predicted_rays = &predicted_rays;
    input.truth_rays = &truth_rays;
    input.training = {camera_at(-0.1), camera_at(0.1)};
    const std::vector<uint8_t> all(predicted.triangles.size(), 1);
    input.seen = HitCache(predicted_rays, all.size(), input.training, pool_).seen({0, 1}, all);
    input.structural = {0, 1};
    return measure_surface(input, pool_);
  }
  ThreadPool pool_{2};
};

TEST_F(SurfaceQualityTest, TheTruthItselfIsPerfect) {
  const TriangleMesh truth = relief(flat);
  const SurfaceQuality q = measure(truth, truth);
  EXPECT_GT(q.normals, 5000u);
  EXPECT_GT(q.edges, 1000u);
  EXPECT_NEAR(q.normal_error.mean, 0, 1e-3);
  EXPECT_NEAR(q.roughness.mean, 0, 1e-3);
  EXPECT_EQ(q.pinholes, 0);
  EXPECT_NEAR(q.truth_seen, 4, 0.2);
}

TEST_F(SurfaceQualityTest, ATiltIsTheNormalErrorOfEveryFace) {
  const double degrees = 1;
  const float slope = static_cast<float>(std::tan(degrees * std::acos(-1.0) / 180));
  const SurfaceQuality q = measure(relief([&](float x, float) { return kDistance + slope * x; }), relief(flat));
  EXPECT_NEAR(q.normal_error.mean, degrees, 0.01);
  EXPECT_NEAR(q.normal_error.median, degrees, 0.01);
  EXPECT_NEAR(q.roughness.mean, 0, 0.01) << "a tilted plane is smooth";
}

TEST_F(SurfaceQualityTest, FoldsAreRoughnessAndHalfOfThemNormalError) {
  // Faces tilt by +-a, neighbours across a ridge or groove differ by 2 a.
  const double a = std::atan(double(kFold)) * 180 / std::acos(-1.0);
  const SurfaceQuality q = measure(relief(folds), relief(flat));
  EXPECT_NEAR(q.normal_error.median, a, 0.05);
  // The edges along the ridges (length c) fold by 2 a. Those across them (c / cos a) and the diagonals are in a face's
  // plane.
  const double across = 1 / std::cos(a * std::acos(-1.0) / 180), diagonal = std::sqrt(1 + across * across);
  EXPECT_NEAR(q.roughness.mean, 2 * a / (1 + across + diagonal), 0.1);
}

TEST_F(SurfaceQualityTest, PinholesAreTheShareOfTheWallThatIsMissing) {
  // One cell in each 10 x 10 is open: 1 %.
  const SurfaceQuality q = measure(relief(flat, [](int i, int j) { return i % 10 == 5 && j % 10 == 5; }), relief(flat));
  EXPECT_NEAR(q.pinholes, 0.01, 0.003);
}

TEST_F(SurfaceQualityTest, AWallThatIsShiftedBySevenCentimetresIsPassedThrough) {
  EXPECT_NEAR(measure(relief([](float, float) { return kDistance + 0.07f; }), relief(flat)).pinholes, 1, 0.05);
  // seen past the true wall's edges nothing is missing
  TriangleMesh wider = relief([](float, float) { return kDistance + 0.03f; });
  for (Vec3f& v : wider.vertices) v = {1.1f * v.x, 1.1f * v.y, v.z};
  EXPECT_EQ(measure(wider, relief(flat)).pinholes, 0);
}

TEST_F(SurfaceQualityTest, AContourThatIsAPixelOffIsNoHole) {
  // A board is 40 cm before the wall; the predicted one is 5 mm (0.75 pixels) narrower.
  const auto with_board = [](float half) {
    TriangleMesh mesh = relief(flat);
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (const auto& [x, y] : {std::pair{-half, -half}, {half, -half}, {-half, half}, {half, half}})
      mesh.vertices.push_back({x, y, kDistance - 0.4f});
    mesh.triangles.push_back({first, first + 2, first + 1});
    mesh.triangles.push_back({first + 1, first + 2, first + 3});
    return mesh;
  };
  EXPECT_EQ(measure(with_board(0.295f), with_board(0.3f)).pinholes, 0);
  EXPECT_GT(measure(with_board(0.1f), with_board(0.3f)).pinholes, 0.02) << "most of the board is missing";
}

TEST_F(SurfaceQualityTest, StructureIsWhatTheTruthCallsSo) {
  TriangleMesh truth = relief(flat);
  for (const Vec3f& v : truth.vertices) truth.labels.push_back(v.x < 0 ? 1 : 0);
  const SurfaceQuality q = measure(relief([](float x, float) { return x < 0 ? kDistance : kDistance + 0.02f * x; },
                                          [](int i, int j) { return i > 30 && j > 30; }),
                                   truth);
  EXPECT_NEAR(q.structure_normal_error.median, 0, 0.01);
  EXPECT_GT(q.normal_error.mean, 0.3);
  EXPECT_EQ(q.structure_pinholes, 0);
  EXPECT_GT(q.pinholes, 0.03);
  EXPECT_TRUE(std::isnan(measure(truth, relief(flat)).structure_normal_error.mean)) << "a truth without labels";
}

TEST_F(SurfaceQualityTest, NothingPredictedIsAllHoleAndHasNoAngles) {
  const SurfaceQuality q = measure(TriangleMesh(), relief(flat));
  EXPECT_EQ(q.pinholes, 1);
  EXPECT_TRUE(std::isnan(q.normal_error.mean));
  EXPECT_TRUE(std::isnan(q.roughness.median));
}

TEST_F(SurfaceQualityTest, FoldedTruthIsNotPlanarAndCountsForNoRoughness) {
  EXPECT_TRUE(std::isnan(measure(relief(folds), relief(folds)).roughness.mean));
}

TEST(NearestSurfacePoint, IsTheFootInsideAnEdgeBesideAndNothingBeyondReach) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const RayScene scene(mesh);
  const auto above = scene.nearest({0.25, 0.25, 0.5}, 1);
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->distance, 0.5, 1e-12);
  EXPECT_NEAR(norm(above->position - Vec3d{0.25, 0.25, 0}), 0, 1e-12);
  const auto beside = scene.nearest({0.5, -0.3, 0}, 1);
  ASSERT_TRUE(beside);
  EXPECT_NEAR(norm(beside->position - Vec3d{0.5, 0, 0}), 0, 1e-12);
  EXPECT_FALSE(scene.nearest({0.25, 0.25, 0.5}, 0.4));
  EXPECT_FALSE(RayScene(TriangleMesh()).nearest({0, 0, 0}, 1));
}

}  // namespace
}  // namespace aligngs
