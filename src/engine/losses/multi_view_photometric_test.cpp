#include "engine/losses/multi_view_photometric.h"

#include <gtest/gtest.h>

#include <limits>

#include "engine/formulas/patch_score.h"
#include "engine/losses/testing/two_view_maps.h"

namespace aligngs {
namespace {

using testing_maps::largest;
using testing_maps::narrow;
using testing_maps::pixelwise_gradient_error;
using testing_maps::show_plane_everywhere;
using testing_maps::TwoViewFixture;

TwoViewFixture fixture(int width = 28, int height = 22) {
  TwoViewFixture f(width, height);
  f.settings.weight[Loss::kMultiViewPhotometric] = 0.7f;
  return f;
}

std::vector<double> grey_of(const ImageF& photo) {
  std::vector<double> grey;
  for (size_t i = 0; i < photo.data.size(); i += 3) {
    grey.push_back(0.299f * photo.data[i] + 0.587f * photo.data[i + 1] + 0.114f * photo.data[i + 2]);
  }
  return grey;
}

/// patch_score of one pixel of a fixture.
struct Scores {
  const TwoViewFixture& f;
  TwoViews<double> views{f.view.data.camera, f.other.data.camera};
  std::vector<double> grey = grey_of(f.view.data.color), other = grey_of(f.other.data.color);
  explicit Scores(const TwoViewFixture& fixture) : f(fixture) {}

  PatchScore<double> operator()(const BlendedPlane<double>& plane, int x, int y) const {
    return patch_score(views, {grey.data(), other.data()}, plane, x, y);
  }
  PatchScore<double> operator()(size_t i) const {
    const size_t n = f.pixels();
    const Vec3d normal{f.maps.normal[i], f.maps.normal[n + i], f.maps.normal[2 * n + i]};
    return (*this)({normal, f.maps.distance[i], f.maps.alpha[i]}, static_cast<int>(i) % f.maps.width,
                   static_cast<int>(i) / f.maps.width);
  }
};

/// The plane of the left wall of the fixture, blended with this opacity.
BlendedPlane<double> left_wall(double alpha) { return {alpha * normalized(Vec3d{0.55, 0.1, -1}), 3.0 * alpha, alpha}; }

TEST(PatchScore, TheTruePlaneScoresBestAndAlphaCancels) {
  const TwoViewFixture f(84, 66);
  const Scores score(f);
  const PatchScore<double> exact = score(left_wall(1), 20, 30);
  ASSERT_TRUE(exact.used);
  EXPECT_LT(exact.score, 0.02);
  EXPECT_NEAR(score(left_wall(0.6), 20, 30).score, exact.score, 1e-12);
  for (const double factor : {0.93, 1.07}) {
    BlendedPlane<double> moved = left_wall(1);
    moved.distance *= factor;
    EXPECT_GT(score(moved, 20, 30).score, exact.score);
  }
}

TEST(PatchScore, IsNotUsedNextToTheBorder) {
  const TwoViewFixture f;
  const Scores score(f);
  for (int x = 0; x < 28; ++x) {
    EXPECT_FALSE(score(left_wall(1), x, 2).used);
    EXPECT_FALSE(score(left_wall(1), x, 19).used);
  }
}

TEST(PatchScore, IsNotUsedForDegeneratePlanes) {
  const TwoViewFixture f;
  const Scores score(f);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(score({Vec3d{0, 0, -1}, 0, 1}, 14, 11).used);
  EXPECT_FALSE(score({Vec3d{0, 0, -1}, -3, 1}, 14, 11).used);
  EXPECT_FALSE(score({Vec3d{0, 0, -1}, 3, 0}, 14, 11).used);
  EXPECT_FALSE(score({Vec3d{0, 0, 1}, 3, 1}, 14, 11).used) << "seen from behind";
  EXPECT_FALSE(score({Vec3d{0, 1, -0.02}, 3, 1}, 14, 11).used) << "edge-on";
  EXPECT_FALSE(score({Vec3d{0, nan, -1}, 3, 1}, 14, 11).used);
  EXPECT_FALSE(score({Vec3d{0, 0, -1}, nan, 1}, 14, 11).used);
}

TEST(PatchScore, IsNotUsedWhereTheOtherPhotoEnds) {
  TwoViewFixture f;
  f.other.data.camera.world_to_camera.translation.x = -20;
  EXPECT_FALSE(Scores(f)(left_wall(1), 14, 11).used);
}

TEST(MultiViewPhotometric, GradientAgreesWithDifferencesOfTheWeightedScores) {
  TwoViewFixture f = fixture();
  MapGradients<double> g;
  MapLossWorkspace<double> workspace;
  const LossTerms terms = f.run(g, nullptr, &workspace);
  const std::vector<double> w = workspace.agreement;  // detached
  double count = 0, sum = 0;
  for (const uint8_t each : workspace.patch_used) count += each;
  ASSERT_GT(count, 30);
  const Scores score(f);
  const auto value = [&](size_t i) {
    return workspace.patch_used[i] ? double(0.7f) * w[i] * score(i).score / count : 0.0;
  };
  for (size_t i = 0; i < f.pixels(); ++i) sum += value(i);
  EXPECT_NEAR(terms.total, sum, 1e-6);  // grey is summed in single precision
  EXPECT_GT(terms[Loss::kMultiViewPhotometric], 0);
  EXPECT_LT(pixelwise_gradient_error(f, g, value), 1e-5);
}

TEST(MultiViewPhotometric, IsZeroForAConstantPhoto) {
  TwoViewFixture f = fixture();
  for (float& v : f.view.data.color.data) v = 0.4f;
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

TEST(MultiViewPhotometric, IsZeroWithoutOverlap) {
  TwoViewFixture f = fixture();
  f.other.data.camera.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{0, 0, 1, 0}));
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

TEST(MultiViewPhotometric, IsZeroForPlanesSeenEdgeOn) {
  TwoViewFixture f = fixture();
  show_plane_everywhere(f, normalized(Vec3d{0, 1, -0.02}), 3);
  MapGradients<double> g;
  f.run(g);
  for (int x = 0; x < f.maps.width; ++x) EXPECT_EQ(g.distance[size_t(11) * f.maps.width + x], 0);
}

TEST(MultiViewPhotometric, PixelsThatAreNotNumbersAreLeftOut) {
  TwoViewFixture f = fixture();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  f.view.data.color.at(9, 9, 1) = nan;
  f.other.data.color.at(12, 12, 0) = nan;
  f.maps.normal[15 * 28 + 10] = std::numeric_limits<double>::quiet_NaN();
  MapGradients<double> g;
  MapLossWorkspace<double> workspace;
  f.run(g, nullptr, &workspace);
  for (const auto* map : {&g.normal, &g.distance}) {
    for (const double v : *map) EXPECT_TRUE(std::isfinite(v));
  }
  for (int y = 6; y <= 12; ++y) {
    for (int x = 6; x <= 12; ++x) EXPECT_EQ(workspace.patch_used[size_t(y) * 28 + x], 0) << x << ", " << y;
  }
}

TEST(MultiViewPhotometric, DrawsTheShareOfPixelsThatTheSeedSays) {
  TwoViewFixture f = fixture(84, 66);
  MapGradients<double> g;
  MapLossWorkspace<double> first, again, another;
  f.run(g, nullptr, &first);
  f.run(g, nullptr, &again);
  f.seed = 6;
  f.run(g, nullptr, &another);
  EXPECT_EQ(first.patch_used, again.patch_used);
  EXPECT_NE(first.patch_used, another.patch_used);
  size_t drawn = 0;
  for (size_t i = 0; i < 100000; ++i) drawn += draws_patch(7, i, 0.25) ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(drawn), 25000, 500);
  EXPECT_TRUE(draws_patch(7, 1, 1.5));
}

TEST(MultiViewTerms, AreTheSameForAnyNumberOfThreads) {
  TwoViewFixture f = fixture(61, 53);
  f.settings.weight[Loss::kMultiViewGeometric] = 0.3f;
  MapGradients<double> one, many;
  const LossTerms first = f.run(one);
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    EXPECT_EQ(f.run(many, &pool).total, first.total);
    EXPECT_EQ(many.normal, one.normal);
    EXPECT_EQ(many.distance, one.distance);
  }
}

TEST(MultiViewTerms, FloatAgreesWithDouble) {
  TwoViewFixture f = fixture(84, 66);
  f.settings.weight[Loss::kMultiViewGeometric] = 0.3f;
  MapGradients<double> exact;
  const LossTerms expected = f.run(exact);
  const std::vector<float> depth(f.other_depth.begin(), f.other_depth.end());
  const NeighbourView<float> neighbour{f.other, depth.data(), f.seed};
  MapGradients<float> g;
  g.reset(f.pixels());
  LossTerms terms;
  map_losses<float>({narrow(f.maps), f.view, f.settings, nullptr, nullptr, &neighbour}, terms, g);
  EXPECT_NEAR(terms[Loss::kMultiViewGeometric], expected[Loss::kMultiViewGeometric],
              1e-3 * expected[Loss::kMultiViewGeometric]);
  EXPECT_NEAR(terms[Loss::kMultiViewPhotometric], expected[Loss::kMultiViewPhotometric],
              1e-3 * expected[Loss::kMultiViewPhotometric]);
  double difference = 0;
  for (size_t i = 0; i < f.pixels(); ++i) difference += std::abs(double(g.distance[i]) - exact.distance[i]);
  double size = 0;
  for (const double d : exact.distance) size += std::abs(d);
  EXPECT_LT(difference, 5e-3 * size);  // single pixels may fall to either side of a threshold
}

}  // namespace
}  // namespace aligngs
