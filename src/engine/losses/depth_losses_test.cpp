// The two depth losses and the depth map under them.
#include <gtest/gtest.h>

#include "engine/losses/depth_map.h"
#include "engine/losses/depth_pearson.h"
#include "engine/losses/testing/maps.h"

namespace aligngs {
namespace {

using testing_maps::largest;
using testing_maps::LossFixture;
using testing_maps::plane_fixture;

const Vec3d kSlanted = normalized(Vec3d{0.6, 0.2, -1});

LossFixture with_pearson(LossFixture f) {
  f.settings.weight[Loss::kPearson] = 1;
  return f;
}

LossFixture with_log_depth(LossFixture f) {
  f.settings.weight[Loss::kLogDepth] = 1;
  return f;
}

void expect_zero(const LossFixture& f) {
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

// Hides all but the first `count` pixels.
void hide_all_but(LossFixture& f, size_t count) {
  for (size_t i = count; i < f.pixels(); ++i) f.maps.alpha[i] = 0.4;
}

TEST(DepthMap, IsTheDepthOfThePlaneAtThePixelCentre) {
  const LossFixture f = plane_fixture(kSlanted, 2);
  for (const bool paper : {false, true}) {
    LossSettings settings;
    settings.paper_normals = paper;
    MapLossWorkspace<double> workspace;
    compute_depth_map<double>({f.maps, f.view, settings, nullptr, nullptr}, workspace);
    for (int y = 0; y < f.maps.height; ++y) {
      for (int x = 0; x < f.maps.width; ++x) {
        const size_t i = size_t(y) * f.maps.width + x;
        EXPECT_NEAR(workspace.depth[i], -2 / dot(kSlanted, f.view.data.camera.ray(x + 0.5, y + 0.5)), 1e-6);
        EXPECT_EQ(workspace.validity[i], kDepthTight);
      }
    }
  }
}

TEST(DepthMap, TrustFallsWithTheDistanceFromTheExpectedDepth) {
  LossFixture f = plane_fixture(kSlanted, 2);
  f.maps.expected[0] *= 1.1;
  f.maps.expected[1] *= 1.5;
  f.maps.expected[2] *= 3;
  f.maps.alpha[3] = 0.5;
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 1.0f);
  f.view.data.mask.data[4] = 0;
  MapLossWorkspace<double> workspace;
  compute_depth_map<double>({f.maps, f.view, f.settings, nullptr, nullptr}, workspace);
  EXPECT_EQ(workspace.validity[0], kDepthTight);
  EXPECT_EQ(workspace.validity[1], kDepthLoose);
  EXPECT_EQ(workspace.validity[2], kDepthInvalid);
  EXPECT_EQ(workspace.validity[3], kDepthInvalid);
  EXPECT_EQ(workspace.validity[4], kDepthInvalid);
}

TEST(DepthMap, AGrazingPlaneHasNoGradientThroughItsNormal) {
  // Seen at 3 degrees, below the clamp of about 5.7: depth = D / (0.1 A |r|).
  LossFixture f = plane_fixture({0, 0, -1}, 2);
  for (size_t i = 0; i < f.pixels(); ++i) {
    const int x = int(i) % f.maps.width, y = int(i) / f.maps.width;
    const Vec3d ray = f.view.data.camera.ray(x + 0.5, y + 0.5);
    const Vec3d n = normalized(cross(ray, Vec3d{0, 1, 0})) - normalized(ray) * 0.05;
    for (int c = 0; c < 3; ++c) f.maps.normal[c * f.pixels() + i] = n[c];
    f.maps.expected[i] = 2 / (0.1 * norm(ray));
  }
  f = with_log_depth(f);
  MapGradients<double> g;
  EXPECT_GT(f.run(g).total, 0);
  EXPECT_GT(std::abs(g.distance[20]), 0);
  for (const double v : g.normal) EXPECT_EQ(v, 0);
}

TEST(Pearson, IgnoresScaleAndShiftOfThePrior) {
  LossFixture f = with_pearson(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z = 0.5f + 3 * z;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kPearson], 1.0 / f.pixels(), 1e-4);  // mean over n of products scaled with n - 1
}

TEST(Pearson, IsTwoForAPriorThatIsUpsideDown) {
  LossFixture f = with_pearson(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z = 20 - 4 * z;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kPearson], 2, 0.01);
}

TEST(Pearson, LooksOnlyOutsideTheLabelEdge) {
  LossFixture f = with_pearson(plane_fixture(kSlanted, 2));
  MapGradients<double> g;
  const double before = f.run(g)[Loss::kPearson];
  f.view.label_edge.at(3, 3) = 1;
  f.view.data.prior_depth.at(3, 3) = 50;
  EXPECT_NEAR(f.run(g)[Loss::kPearson], before, 1e-3);
  EXPECT_EQ(g.distance[size_t(3) * f.maps.width + 3], 0);
}

TEST(Pearson, IsZeroForAFrontalPrior) {
  LossFixture f = with_pearson(plane_fixture(kSlanted, 2));
  std::fill(f.view.data.prior_depth.data.begin(), f.view.data.prior_depth.data.end(), 3.0f);
  expect_zero(f);
}

TEST(Pearson, IsZeroForAFrontalRendering) {
  LossFixture f = with_pearson(plane_fixture({0, 0, -1}, 2));
  for (size_t i = 0; i < f.pixels(); ++i) f.view.data.prior_depth.data[i] = 1 + 0.1f * float(i % 7);
  expect_zero(f);
}

TEST(Pearson, IsZeroWithFewerThanFivePercentValidPixels) {
  LossFixture f = with_pearson(plane_fixture(kSlanted, 2));
  hide_all_but(f, 7);  // of 154
  expect_zero(f);
}

TEST(Pearson, IsZeroWithoutAPrior) {
  LossFixture f = with_pearson(LossFixture());
  f.view.data.prior_depth = {};
  expect_zero(f);
}

TEST(LogDepth, IsLinearBeyondTheHuberWidth) {
  LossFixture f = with_log_depth(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z *= std::exp(-0.1f);
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kLogDepth], 0.1 - 0.01, 1e-6);
}

TEST(LogDepth, IsQuadraticWithinTheHuberWidth) {
  LossFixture f = with_log_depth(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z *= std::exp(0.01f);
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kLogDepth], 0.01 * 0.01 / (2 * 0.02), 1e-6);
}

TEST(LogDepth, AppliesTheScaleOfTheView) {
  LossFixture f = with_log_depth(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z /= 1.3f;
  f.settings.prior_depth_scale = 1.3f;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kLogDepth], 0, 1e-10);
}

TEST(LogDepth, IsAMeanByWeight) {
  LossFixture f = with_log_depth(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z *= std::exp(-0.1f);
  for (size_t i = 0; i < f.pixels(); i += 2) {
    f.view.data.prior_depth.data[i] *= std::exp(-0.4f);  // error 0.5 at a third of the weight
    f.view.depth_weight.data[i] = 0.5f;
  }
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kLogDepth], (0.49 * 0.5 + 0.09 * 1) / 1.5, 1e-6);
}

TEST(LogDepth, IsZeroWithFewerThanOnePercentValidPixels) {
  LossFixture f = with_log_depth(plane_fixture(kSlanted, 2));
  for (float& z : f.view.data.prior_depth.data) z *= 1.1f;
  hide_all_but(f, 1);  // of 154
  expect_zero(f);
}

TEST(LogDepth, IsZeroWithoutAPrior) {
  LossFixture f = with_log_depth(LossFixture());
  f.view.data.prior_depth = {};
  expect_zero(f);
}

}  // namespace
}  // namespace aligngs
