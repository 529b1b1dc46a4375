// The losses of the normal map: consistency with depth, the prior, and label edges.
#include <gtest/gtest.h>

#include "engine/losses/crease.h"
#include "engine/losses/normal_boundary.h"
#include "engine/losses/testing/maps.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using testing_maps::largest;
using testing_maps::LossFixture;
using testing_maps::plane_fixture;
using testing_maps::show_plane;

constexpr double kRadian = 3.14159265358979323846 / 180;
const Vec3d kFrontal{0, 0, -1};
const Vec3d kSlantedNormal = normalized(Vec3d{0.6, 0.2, -1});

// A unit normal turned by an angle from the frontal one, about the y axis.
Vec3d turned(double degrees) { return {std::sin(degrees * kRadian), 0, -std::cos(degrees * kRadian)}; }

void set_normal(LossFixture& f, int x, int y, const Vec3d& n) {
  for (int c = 0; c < 3; ++c) f.maps.normal[c * f.pixels() + size_t(y) * f.maps.width + x] = n[c];
}

// Two half images that meet between columns 6 and 7, labels 0 and 1, rendered and prior alike.
LossFixture folded(const Vec3d& left, double d_left, const Vec3d& right, double d_right) {
  LossFixture f = plane_fixture(left, d_left);
  for (int y = 0; y < f.maps.height; ++y) {
    for (int x = 7; x < f.maps.width; ++x) {
      show_plane(f, x, y, right, d_right);
      f.view.data.labels.at(x, y) = 1;
    }
  }
  return f;
}

// Plane through the point at depth 2 on the ray between columns 6 and 7.
double distance_through_seam(const LossFixture& f, const Vec3d& n) {
  return -2 * dot(n, f.view.data.camera.ray(7, f.view.data.camera.cy));
}

void expect_zero_normal_losses(const LossFixture& f) {
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

TEST(NormalConsistency, IsZeroOnAPlane) {
  for (const bool paper : {false, true}) {
    LossFixture f = plane_fixture(kSlantedNormal, 2);
    f.settings.weight[Loss::kNormalConsistency] = 1;
    f.settings.paper_normals = paper;
    MapGradients<double> g;
    EXPECT_NEAR(f.run(g)[Loss::kNormalConsistency], 0, 1e-12);
    EXPECT_LT(largest(g), 1e-5);
  }
}

TEST(NormalConsistency, IsOneMinusTheCosineOfTheAngle) {
  // Normals blended at half length and turned by 60 degrees; depth kept by the matching distance.
  for (const bool paper : {false, true}) {
    LossFixture f = plane_fixture(kFrontal, 2, 40, 30);
    f.view.data.camera.fx = f.view.data.camera.fy = 400;  // narrow: no clamp at the image's rim
    const Vec3d n = turned(60) * 0.5;
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        set_normal(f, x, y, n);
        f.maps.distance[size_t(y) * 40 + x] = 2 * -dot(n, f.view.data.camera.ray(x + 0.5, y + 0.5));
      }
    }
    f.settings.weight[Loss::kNormalConsistency] = 1;
    f.settings.paper_normals = paper;
    MapGradients<double> g;
    EXPECT_NEAR(f.run(g)[Loss::kNormalConsistency], 0.5, 1e-6);
  }
}

TEST(NormalConsistency, DoesNotDifferentiateAcrossADepthJump) {
  LossFixture f = folded(kFrontal, 2, kFrontal, 3);
  f.settings.weight[Loss::kNormalConsistency] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kNormalConsistency], 0, 1e-12);
  f.settings.paper_normals = true;
  EXPECT_GT(f.run(g)[Loss::kNormalConsistency], 0.05);  // as printed it does
}

TEST(NormalConsistency, DoesNotDifferentiateAcrossAHole) {
  LossFixture f = plane_fixture(kSlantedNormal, 2);
  f.maps.alpha[size_t(5) * f.maps.width + 6] = 0.2;
  f.settings.weight[Loss::kNormalConsistency] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kNormalConsistency], 0, 1e-12);
  EXPECT_EQ(g.distance[size_t(5) * f.maps.width + 6], 0);
}

TEST(NormalConsistency, IsZeroWithFewerThanOnePercentValidPixels) {
  LossFixture f(14, 11);
  for (size_t i = 0; i < f.pixels(); ++i) f.maps.alpha[i] = i < 3 ? 0.9 : 0.3;  // no pixel has two neighbours
  f.settings.weight[Loss::kNormalConsistency] = 1;
  expect_zero_normal_losses(f);
}

TEST(NormalConsistency, CancelledNormalsHaveNoDirection) {
  LossFixture f(14, 11);
  for (double& v : f.maps.normal) v *= 0.05;
  f.settings.weight[Loss::kPriorNormal] = 1;
  expect_zero_normal_losses(f);
}

TEST(PriorNormal, IsOneMinusTheCosineOfTheAngle) {
  LossFixture f = plane_fixture(turned(60), 2);
  for (size_t i = 0; i < f.pixels(); ++i) {
    for (int c = 0; c < 3; ++c) f.view.prior_normal.data[3 * i + c] = static_cast<float>(kFrontal[c]);
  }
  f.settings.weight[Loss::kPriorNormal] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kPriorNormal], 0.5, 1e-12);
}

TEST(PriorNormal, IsZeroWithoutOne) {
  LossFixture f;
  f.settings.weight[Loss::kPriorNormal] = 1;
  f.view.prior_normal = {};
  expect_zero_normal_losses(f);
  LossFixture empty;
  empty.settings.weight[Loss::kPriorNormal] = 1;
  std::fill(empty.view.prior_normal.data.begin(), empty.view.prior_normal.data.end(), 0.0f);
  expect_zero_normal_losses(empty);
}

TEST(NormalBoundary, PenaltyFollowsTheTableOfTheMethod) {
  const double angles[] = {0, 5, 10, 15, 20, 30}, expected[] = {0.5, 0.406, 0.180, 0.032, 0.0024, 1.5e-6};
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(boundary_penalty(std::cos(angles[k] * kRadian)), expected[k], expected[k] * 0.03) << angles[k];
  }
}

TEST(NormalBoundary, IsTheMeanPenaltyOverPairs) {
  for (const bool paper : {false, true}) {
    LossFixture f = plane_fixture(kFrontal, 2);
    f = folded(kFrontal, 2, turned(10), distance_through_seam(f, turned(10)));
    f.settings.weight[Loss::kNormalBoundary] = 1;
    f.settings.paper_normals = paper;
    MapGradients<double> g;
    EXPECT_NEAR(f.run(g)[Loss::kNormalBoundary], boundary_penalty(std::cos(10 * kRadian)), 1e-9);
  }
}

TEST(NormalBoundary, LeavesOutDepthJumpsUnlessAsPrinted) {
  LossFixture f = folded(kFrontal, 2, kFrontal, 3);
  f.settings.weight[Loss::kNormalBoundary] = 1;
  expect_zero_normal_losses(f);
  f.settings.paper_normals = true;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kNormalBoundary], 0.5, 1e-9);
}

TEST(NormalBoundary, IsZeroForOneLabel) {
  LossFixture f;
  f.settings.weight[Loss::kNormalBoundary] = 1;
  f.settings.paper_normals = true;
  std::fill(f.view.data.labels.data.begin(), f.view.data.labels.data.end(), uint16_t(7));
  expect_zero_normal_losses(f);
  std::fill(f.view.data.labels.data.begin(), f.view.data.labels.data.begin() + 40, kNoLabel);
  expect_zero_normal_losses(f);  // unknown is not a class
}

TEST(ClassifyEdge, AFoldWithoutAJumpIsACrease) {
  const Vec3d ray{0, 0, 1};
  EXPECT_EQ(classify_edge(turned(30), {-0.05, 0, 2 - 0.05 * std::tan(30 * kRadian)}, turned(-30),
                          {0.05, 0, 2 - 0.05 * std::tan(30 * kRadian)}, ray),
            EdgeKind::kCrease);
}

TEST(ClassifyEdge, ASlantedPlaneIsCoplanar) {
  const double slope = std::tan(60 * kRadian);
  EXPECT_EQ(classify_edge(turned(60), {-0.1, 0, 2 - 0.1 * slope}, turned(60), {0.1, 0, 2 + 0.1 * slope}, {0, 0, 1}),
            EdgeKind::kCoplanar);
}

TEST(ClassifyEdge, ADepthJumpIsNothing) {
  EXPECT_EQ(classify_edge(kFrontal, {-0.1, 0, 2}, kFrontal, {0.1, 0, 2.1}, {0, 0, 1}), EdgeKind::kNothing);
  EXPECT_EQ(classify_edge(turned(40), {-0.01, 0, 2}, turned(-40), {0.01, 0, 2.5}, {0, 0, 1}), EdgeKind::kNothing);
}

TEST(ClassifyEdge, AnAngleBetweenTheThresholdsIsNothing) {
  EXPECT_EQ(classify_edge(kFrontal, {0, 0, 2}, turned(18), {0, 0, 2}, {0, 0, 1}), EdgeKind::kNothing);
}

TEST(ClassifyEdge, MissingNormalsAreNothing) {
  EXPECT_EQ(classify_edge({}, {0, 0, 2}, kFrontal, {0, 0, 2}, {0, 0, 1}), EdgeKind::kNothing);
}

TEST(Crease, SupervisesEachSideByItsOwnPrior) {
  LossFixture f = plane_fixture(kFrontal, 2);
  f = folded(kFrontal, 2, turned(50), distance_through_seam(f, turned(50)));
  f.settings.weight[Loss::kCrease] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kCrease], 0, 1e-7);  // rendered as the prior says
  for (int y = 0; y < f.maps.height; ++y) {
    set_normal(f, 5, y, turned(60));  // 2 px left of the edge; the prior there is frontal
  }
  EXPECT_NEAR(f.run(g)[Loss::kCrease], 0.5 / 2, 1e-7);  // half of the terms
}

TEST(Crease, SmoothsAcrossACoplanarEdge) {
  LossFixture f = folded(kFrontal, 2, kFrontal, 2);
  for (int y = 0; y < f.maps.height; ++y) set_normal(f, 7, y, turned(60));
  f.settings.weight[Loss::kCrease] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kCrease], 0.5, 1e-9);
}

TEST(Crease, ALoneEdgePixelCarriesLittle) {
  LossFixture f = folded(kFrontal, 2, kFrontal, 2);
  for (int y = 1; y < f.maps.height; ++y) {
    for (int x = 0; x < f.maps.width; ++x) f.view.data.labels.at(x, y) = kNoLabel;
  }
  set_normal(f, 7, 0, turned(60));
  f.settings.weight[Loss::kCrease] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(f.run(g)[Loss::kCrease], 0.5 / (kCreaseMinimumShare * f.pixels()), 1e-9);
}

TEST(Crease, IsZeroForOneLabelOrWithoutPriors) {
  LossFixture f = plane_fixture(turned(60), 2);
  f.settings.weight[Loss::kCrease] = 1;
  expect_zero_normal_losses(f);
  LossFixture unknown = LossFixture();
  unknown.settings.weight[Loss::kCrease] = 1;
  unknown.view.data.labels = {};
  expect_zero_normal_losses(unknown);
  LossFixture no_prior;
  no_prior.settings.weight[Loss::kCrease] = 1;
  no_prior.view.prior_normal = {};
  expect_zero_normal_losses(no_prior);
}

}  // namespace
}  // namespace aligngs
