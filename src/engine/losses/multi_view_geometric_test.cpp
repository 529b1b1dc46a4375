#include "engine/losses/multi_view_geometric.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "engine/formulas/two_views.h"
#include "engine/losses/testing/two_view_maps.h"

namespace aligngs {
namespace {

using testing_maps::largest;
using testing_maps::pixelwise_gradient_error;
using testing_maps::show_plane_everywhere;
using testing_maps::TwoViewFixture;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TwoViewFixture geometric_fixture() {
  TwoViewFixture f;
  f.settings.weight[Loss::kMultiViewGeometric] = 0.7f;
  return f;
}

TEST(SampleBilinear, IsThePixelAtItsCentreAndGoesOnBeyondTheBorder) {
  const float map[6] = {1, 2, 4, 3, 5, 9};  // 3 x 2
  EXPECT_EQ((sample_bilinear<double>(map, 3, 2, {1.5, 0.5})).value, 2);
  EXPECT_EQ((sample_bilinear<double>(map, 3, 2, {1.0, 1.0})).value, 2.75);
  EXPECT_EQ((sample_bilinear<double>(map, 3, 2, {-4.0, 9.0})).value, 3);
  EXPECT_EQ((sample_bilinear<double>(map, 3, 2, {-4.0, 1.0})).dx, 0);
  EXPECT_EQ((sample_bilinear<double>(map, 1, 1, {0.7, 0.2})).value, 1);
}

TEST(SampleBilinear, DerivativesMatchDifferences) {
  const double map[12] = {1, 2, 4, 3, 5, 9, -1, 0.5, 2, 7, 1, 3};  // 4 x 3
  const Vec2<double> p{1.83, 1.21};
  const auto at = [&](double x, double y) { return sample_bilinear<double>(map, 4, 3, {x, y}).value; };
  const BilinearSample<double> s = sample_bilinear<double>(map, 4, 3, p);
  EXPECT_NEAR(s.dx, (at(p.x + 1e-6, p.y) - at(p.x - 1e-6, p.y)) / 2e-6, 1e-8);
  EXPECT_NEAR(s.dy, (at(p.x, p.y + 1e-6) - at(p.x, p.y - 1e-6)) / 2e-6, 1e-8);
}

TEST(ForwardBackward, TheTrueDepthComesHome) {
  // One wall and a fine other depth map: bilinear depth is exact up to the curvature of 1 / z.
  TwoViewFixture f(56, 44);
  const TwoViews<double> views(f.view.data.camera, f.other.data.camera);
  const Vec3d p = f.view.data.camera.world_to_camera * TwoViewFixture::wall_point(f.view.data.camera, 14, 20);
  const Reprojection<double> r = forward_backward(views, f.other_depth.data(), p.z, {14.5, 20.5});
  EXPECT_TRUE(r.valid);
  EXPECT_LT(r.distance, 1e-3);
}

TEST(ForwardBackward, SlopeMatchesDifferences) {
  const TwoViewFixture f;
  const TwoViews<double> views(f.view.data.camera, f.other.data.camera);
  int checked = 0;
  for (int y = 3; y < 19; y += 3) {
    for (int x = 3; x < 25; x += 3) {
      const Vec2<double> p{x + 0.5, y + 0.5};
      const double z =
          1.04 * (f.view.data.camera.world_to_camera * TwoViewFixture::wall_point(f.view.data.camera, x, y)).z;
      const auto at = [&](double depth) { return forward_backward(views, f.other_depth.data(), depth, p); };
      const Reprojection<double> r = at(z);
      if (!r.valid) continue;
      EXPECT_NEAR(r.slope, (at(z + 1e-6).distance - at(z - 1e-6).distance) / 2e-6, 1e-6 * std::abs(r.slope) + 1e-7);
      ++checked;
    }
  }
  EXPECT_GT(checked, 20);
}

TEST(ForwardBackward, IsNotValidOutsideTheOtherImageOrBehindIt) {
  TwoViewFixture f;
  f.other.data.camera.world_to_camera.translation.z = -10;  // beyond the wall
  const TwoViews<double> behind(f.view.data.camera, f.other.data.camera);
  EXPECT_FALSE(forward_backward(behind, f.other_depth.data(), 3.0, {14.5, 11.5}).valid);
  f.other.data.camera.world_to_camera.translation = {-30, 0, 0};
  const TwoViews<double> beside(f.view.data.camera, f.other.data.camera);
  EXPECT_FALSE(forward_backward(beside, f.other_depth.data(), 3.0, {14.5, 11.5}).valid);
}

TEST(MultiViewGeometric, GradientAgreesWithDifferencesOfTheWeightedDistance) {
  TwoViewFixture f = geometric_fixture();
  MapGradients<double> g;
  MapLossWorkspace<double> workspace;
  const LossTerms terms = f.run(g, nullptr, &workspace);
  const std::vector<double> w = workspace.agreement;  // detached
  double count = 0, sum = 0;
  for (const double each : w) count += each > 0 ? 1 : 0;
  ASSERT_GT(count, 0.5 * static_cast<double>(f.pixels()));
  const TwoViews<double> views(f.view.data.camera, f.other.data.camera);
  const auto value = [&](size_t i) {
    if (!(w[i] > 0)) return 0.0;
    const int x = static_cast<int>(i) % f.maps.width, y = static_cast<int>(i) / f.maps.width;
    const size_t n = f.pixels();
    const Vec3d normal{f.maps.normal[i], f.maps.normal[n + i], f.maps.normal[2 * n + i]};
    const double z =
        plane_depth(normal, f.maps.distance[i], f.maps.alpha[i], f.view.data.camera.ray(x + 0.5, y + 0.5)).z;
    return double(0.7f) * w[i] * forward_backward(views, f.other_depth.data(), z, {x + 0.5, y + 0.5}).distance / count;
  };
  for (size_t i = 0; i < f.pixels(); ++i) sum += value(i);
  EXPECT_NEAR(terms.total, sum, 1e-12);
  EXPECT_GT(terms[Loss::kMultiViewGeometric], 0);
  EXPECT_LT(pixelwise_gradient_error(f, g, value), 1e-5);
}

TEST(MultiViewGeometric, PullsAMovedWallBack) {
  TwoViewFixture f = geometric_fixture();
  for (int side = -1; side <= 1; side += 2) {
    for (int y = 0; y < f.maps.height; ++y) {
      for (int x = 0; x < f.maps.width; ++x) {
        const Vec3d p = TwoViewFixture::wall_point(f.view.data.camera, x, y);
        testing_maps::show_plane(f, x, y, Vec3d{0, 0, -1}, p.z * (1 + 0.02 * side));
      }
    }
    MapGradients<double> g;
    f.run(g);
    double push = 0;
    for (const double d : g.distance) push += d;
    EXPECT_GT(push * side, 0) << "descent must lower a distance that is too large and raise one that is too small";
  }
}

TEST(MultiViewGeometric, DoesNotActWithoutANeighbour) {
  const TwoViewFixture f = geometric_fixture();
  MapGradients<double> g;
  EXPECT_EQ(f.LossFixture::run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

void expect_nothing(const TwoViewFixture& f) {
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

TEST(MultiViewGeometric, IsZeroWithoutOverlap) {
  TwoViewFixture f = geometric_fixture();
  f.other.data.camera.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{0, 0, 1, 0}));
  expect_nothing(f);
}

TEST(MultiViewGeometric, IsZeroWhereTheNeighbourHasNoDepth) {
  TwoViewFixture f = geometric_fixture();
  for (const double none : {0.0, -1.0, kNotANumber, std::numeric_limits<double>::infinity()}) {
    f.other_depth.assign(f.pixels(), none);
    expect_nothing(f);
  }
}

TEST(MultiViewGeometric, IsZeroWhereTheViewsSeeDifferentSurfaces) {
  TwoViewFixture f = geometric_fixture();
  for (double& z : f.other_depth) z *= 0.5;  // something in front of the wall
  expect_nothing(f);
}

TEST(MultiViewGeometric, IsZeroForAPlaneSeenEdgeOn) {
  TwoViewFixture f = geometric_fixture();
  show_plane_everywhere(f, Vec3d{0, 1, 0}, 3);  // every pixel's plane lies along its ray, or nearly
  MapGradients<double> g;
  f.run(g);
  for (int c = 0; c < 3; ++c) {
    for (int x = 0; x < f.maps.width; ++x) {  // the middle rows: slopes below the guard have no gradient by the normal
      EXPECT_EQ(g.normal[size_t(c) * f.pixels() + size_t(11) * f.maps.width + x], 0);
    }
  }
}

TEST(MultiViewGeometric, MapsThatAreNotNumbersAreLeftOut) {
  TwoViewFixture f = geometric_fixture(), without = geometric_fixture();
  f.maps.distance[100] = kNotANumber;
  f.maps.normal[101] = kNotANumber;
  f.maps.expected[102] = kNotANumber;
  f.other_depth[200] = kNotANumber;
  for (const size_t i : {100, 101, 102}) without.maps.alpha[i] = 0;
  without.other_depth[200] = 0;
  MapGradients<double> g, wanted;
  const LossTerms terms = f.run(g);
  EXPECT_GT(terms.total, 0);
  EXPECT_EQ(terms.total, without.run(wanted).total);
  EXPECT_EQ(g.normal, wanted.normal);
  EXPECT_EQ(g.distance, wanted.distance);
}

TEST(MultiViewGeometric, ANeighbourWithoutAPhotoOfItsSizeIsAnError) {
  TwoViewFixture f = geometric_fixture();
  f.other.data.color = ImageF(3, 3, 3);
  MapGradients<double> g;
  try {
    f.run(g);
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_EQ(e.details().field, "color");
  }
}

TEST(KeepNeighbourDepth, KeepsTheTightDepthsAndSurvivesTheNextLosses) {
  TwoViewFixture f = geometric_fixture();
  f.maps.expected[50] *= 1.5;  // a depth that is only loosely supported
  MapLossWorkspace<double> workspace;
  keep_neighbour_depth<double>({f.maps, f.view, f.settings}, workspace);
  const std::vector<double> kept = workspace.neighbour_depth;
  ASSERT_EQ(kept.size(), f.pixels());
  EXPECT_EQ(kept[50], 0);
  EXPECT_NEAR(kept[51], f.maps.median[51], 0.2);
  MapGradients<double> g;
  f.run(g, nullptr, &workspace);
  EXPECT_EQ(workspace.neighbour_depth, kept);
}

}  // namespace
}  // namespace aligngs
