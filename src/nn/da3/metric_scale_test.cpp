#include "nn/da3/metric_scale.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "nn/da3/metric.h"

namespace aligngs::nn {
namespace {

constexpr double kFocal = 450;

/// Frames of depth 1 to 2, and a metric network that sees the same at `metres` per unit. The upper rows are sky.
void make_room(double metres, int64_t sky_rows, std::vector<Da3Frame>& frames, std::vector<FeatureMap>& metric) {
  for (int s = 0; s < 2; ++s) {
    Da3Frame frame;
    frame.camera.fx = frame.camera.fy = kFocal;
    frame.camera.translation = {1, 2, 3};
    frame.depth = FeatureMap(14, 28, 2);
    FeatureMap map(14, 28, 2);
    for (int64_t i = 0; i < map.places(); ++i) {
      const double d = 1 + double(i % 28) / 28;
      frame.depth.data[size_t(2 * i)] = float(d);
      frame.depth.data[size_t(2 * i + 1)] = float(1 + i % 7);
      map.data[size_t(2 * i)] = float(d * metres * kDa3MetricFocal / kFocal);
      map.data[size_t(2 * i + 1)] = i / 28 < sky_rows ? 1.0f : 0.0f;
    }
    frames.push_back(std::move(frame));
    metric.push_back(std::move(map));
  }
}

TEST(MetricScale, TheScaleIsFoundAndAppliedToDepthAndCameras) {
  std::vector<Da3Frame> frames;
  std::vector<FeatureMap> metric;
  make_room(2.5, 0, frames, metric);
  EXPECT_NEAR(da3_metric_scale(frames, metric).scale, 2.5, 1e-6);
  EXPECT_NEAR(make_da3_metric(frames, metric).scale, 2.5, 1e-6);
  EXPECT_NEAR(frames[1].camera.translation[2], 7.5, 1e-5);
  EXPECT_NEAR(frames[0].depth.data[0], 2.5, 1e-5);
}

TEST(MetricScale, SkyIsFarAndDoesNotDecide) {
  std::vector<Da3Frame> frames;
  std::vector<FeatureMap> metric;
  make_room(2.5, 3, frames, metric);
  for (FeatureMap& map : metric) map.data[0] = 1e6f;
  const MetricScale found = make_da3_metric(frames, metric);
  EXPECT_NEAR(found.scale, 2.5, 1e-6);
  EXPECT_LT(found.pixels, 2u * 11u * 28u);
  EXPECT_NEAR(frames[0].depth.data[0], 2.5 * (1 + 27.0 / 28), 1e-4);
  EXPECT_EQ(frames[0].depth.data[1], 1);
}

TEST(MetricScale, AllSkyIsRefused) {
  std::vector<Da3Frame> frames;
  std::vector<FeatureMap> metric;
  make_room(1, 14, frames, metric);
  EXPECT_THROW(da3_metric_scale(frames, metric), Error);
  metric.pop_back();
  EXPECT_THROW(da3_metric_scale(frames, metric), Error);
}

TEST(MetricScale, AFewPixelsOfSkyAreLeftAsTheyAre) {
  FeatureMap map(4, 8, 2);
  for (int64_t i = 0; i < map.places(); ++i) {
    map.data[size_t(2 * i)] = float(i);
    map.data[size_t(2 * i + 1)] = i < 10 ? 1.0f : 0.0f;
  }
  std::vector<FeatureMap> maps = {map};
  fill_da3_sky(maps);
  EXPECT_EQ(maps[0].data, map.data);
  maps[0].data[21] = 1;  // the eleventh
  fill_da3_sky(maps);
  EXPECT_NEAR(maps[0].data[0], 11 + 0.99 * 20, 1e-4);
}

TEST(MetricScale, QuantilesLieBetweenNeighbours) {
  EXPECT_DOUBLE_EQ(quantile_of({3}, 0.99), 3);
  EXPECT_DOUBLE_EQ(quantile_of({4, 1, 2, 3}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile_of({4, 1, 2, 3}, 1), 4);
}

}  // namespace
}  // namespace aligngs::nn
