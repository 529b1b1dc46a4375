#include "priors/metres_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"

namespace aligngs {
namespace {

constexpr int64_t kWidth = 28, kHeight = 14;
constexpr double kFocal = 450;  // pixels; metres are depth * 450 / 300

/// A slanted floor at 1 to 3 units, and what the metric network says of it at `metres` per unit.
struct MeasuredPhoto {
  nn::Da3Frame frame;
  nn::FeatureMap metric{kHeight, kWidth, 2};
};
MeasuredPhoto photo_of(double metres, double noise = 0, uint64_t seed = 1) {
  MeasuredPhoto p;
  p.frame.camera.fx = p.frame.camera.fy = kFocal;
  p.frame.depth = nn::FeatureMap(kHeight, kWidth, 2);
  Random random(seed);
  for (int64_t i = 0; i < kWidth * kHeight; ++i) {
    const double unit = 1 + 2.0 * double(i) / double(kWidth * kHeight);
    p.frame.depth.data[size_t(2 * i)] = float(unit);
    p.frame.depth.data[size_t(2 * i + 1)] = 2;
    p.metric.data[size_t(2 * i)] = float(unit * metres / kFocal * 300 * std::exp(noise * (2 * random.uniform() - 1)));
    p.metric.data[size_t(2 * i + 1)] = 0;
  }
  return p;
}

TEST(MetresEstimate, APhotoTellsItsScaleThroughTheFocalLength) {
  const MeasuredPhoto p = photo_of(2.5);
  EXPECT_NEAR(*log_metres_of_photo(p.frame, p.metric), std::log(2.5), 1e-5);
}

TEST(MetresEstimate, SkyAndUnsurePixelsDoNotCount) {
  MeasuredPhoto p = photo_of(2.5);
  for (int64_t i = 0; i < kWidth * kHeight / 4; ++i) {
    p.metric.data[size_t(2 * i)] = 500;  // sky, a hundred metres off
    p.metric.data[size_t(2 * i + 1)] = 1;
    p.frame.depth.data[size_t(2 * (kWidth * kHeight - 1 - i))] = 40;  // unsure
    p.frame.depth.data[size_t(2 * (kWidth * kHeight - 1 - i) + 1)] = 1;
  }
  EXPECT_NEAR(*log_metres_of_photo(p.frame, p.metric), std::log(2.5), 1e-5);
}

TEST(MetresEstimate, NoiseOfTenPercentAveragesOut) {
  const MeasuredPhoto p = photo_of(0.4, 0.1);
  EXPECT_NEAR(*log_metres_of_photo(p.frame, p.metric), std::log(0.4), 0.02);
}

TEST(MetresEstimate, PhotosThatTellNothingHaveNoScale) {
  MeasuredPhoto sky = photo_of(1), broken = photo_of(1), other = photo_of(1);
  for (int64_t i = 0; i < kWidth * kHeight; ++i) {
    sky.metric.data[size_t(2 * i + 1)] = 1;
    broken.frame.depth.data[size_t(2 * i)] = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_FALSE(log_metres_of_photo(sky.frame, sky.metric));
  EXPECT_FALSE(log_metres_of_photo(broken.frame, broken.metric));
  EXPECT_FALSE(log_metres_of_photo(other.frame, nn::FeatureMap(kHeight, kWidth / 2, 2)));
  EXPECT_FALSE(metres_estimate({}));
}

TEST(MetresEstimate, TheRoomTakesTheMedianOfItsPhotos) {
  const auto found = metres_estimate({std::log(2.0), std::log(2.1), std::log(1.9), std::log(2.0), std::log(9.0)});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 2.0, 1e-9);
  EXPECT_EQ(found->photos, 5u);
  EXPECT_NEAR(found->spread, 1.4826 * std::log(2.1 / 2.0), 1e-3);  // one wrong photo hardly widens it
}

TEST(MetresEstimate, AgreementHasNoSpread) {
  EXPECT_DOUBLE_EQ(metres_estimate({0.5, 0.5, 0.5})->spread, 0);
  EXPECT_DOUBLE_EQ(metres_estimate({0.5})->spread, 0);
}

}  // namespace
}  // namespace aligngs
