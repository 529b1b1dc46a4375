#include "priors/vggt_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace aligngs {
namespace {

nn::VggtCamera network_camera(int width, int height, double focal) {
  nn::VggtCamera camera;
  camera.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.fx = camera.fy = focal;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  return camera;
}

nn::FeatureMap network_depth(int width, int height, float z = 2) {
  nn::FeatureMap map(height, width, 2);
  for (int64_t p = 0; p < map.places(); ++p) {
    map.data[size_t(2 * p)] = z;
    map.data[size_t(2 * p + 1)] = 3;
  }
  return map;
}

TEST(VggtPrediction, CameraOfALandscapePhotoKeepsItsFieldOfView) {
  // 1036 x 784 becomes 518 x 392: half the size in both directions.
  const Camera camera = camera_of_photo(network_camera(518, 392, 300), {0.5, 0.5, 0, 0}, 1036, 784);
  EXPECT_DOUBLE_EQ(camera.fx, 600);
  EXPECT_DOUBLE_EQ(camera.cx, 518);
  EXPECT_DOUBLE_EQ(camera.cy, 392);
}

TEST(VggtPrediction, CameraOfAPaddedPortraitHasItsCentreInThePhoto) {
  Image<uint8_t> photo(300, 400, 3);
  nn::VggtPlacement placement;
  const Image<uint8_t> input = nn::vggt_image(photo, nn::VggtFit::kPad, &placement);
  const Camera camera = camera_of_photo(network_camera(input.width, input.height, 400), placement, 300, 400);
  EXPECT_NEAR(camera.cx, 150, 0.5);
  EXPECT_NEAR(camera.cy, 200, 0.5);
  EXPECT_NEAR(camera.fx, 400 / placement.scale_x, 1e-9);
}

TEST(VggtPrediction, MapsHaveTheAspectOfThePhoto) {
  // 779 x 520 becomes 518 x 350, whose aspect is not the photo's.
  nn::VggtPlacement placement;
  const Image<uint8_t> input = nn::vggt_image(Image<uint8_t>(779, 520, 3), nn::VggtFit::kCrop, &placement);
  ASSERT_EQ(input.height, 350);
  const PhotoMaps maps = maps_of_photo(network_depth(518, 350), placement, 779, 520);
  EXPECT_NEAR(double(maps.depth.width) / maps.depth.height, 779.0 / 520, 0.005);
  for (const float z : maps.depth.data) ASSERT_FLOAT_EQ(z, 2);
  for (const float c : maps.confidence.data) ASSERT_FLOAT_EQ(c, 3);
}

TEST(VggtPrediction, ThePaddingIsNoPartOfTheMap) {
  nn::VggtPlacement placement;
  nn::vggt_image(Image<uint8_t>(300, 400, 3), nn::VggtFit::kPad, &placement);
  nn::FeatureMap depth = network_depth(518, 518);
  for (int64_t y = 0; y < 518; ++y) {
    for (int64_t x = 0; x < 518; ++x) {
      const bool inside = double(x) >= placement.offset_x && double(x) < placement.offset_x + 300 * placement.scale_x;
      if (!inside) depth.at(y, x)[0] = 100;
    }
  }
  const PhotoMaps maps = maps_of_photo(depth, placement, 300, 400);
  EXPECT_GT(maps.depth.height, maps.depth.width);
  for (const float z : maps.depth.data) ASSERT_FLOAT_EQ(z, 2);
}

TEST(VggtPrediction, DepthKeepsItsPlaceUnderTheHalfPixelRule) {
  // Depth grows by 0.01 per pixel of the network's input. At twice the size pixel x of the photo has its centre at (x +
  // 0.5) / 2 of the input.
  nn::FeatureMap depth = network_depth(56, 28);
  for (int64_t y = 0; y < 28; ++y) {
    for (int64_t x = 0; x < 56; ++x) depth.at(y, x)[0] = 10 + 0.01f * (float(x) + 0.5f);
  }
  const PhotoMaps maps = maps_of_photo(depth, {0.5, 0.5, 0, 0}, 112, 56);
  ASSERT_EQ(maps.depth.width, 56);
  EXPECT_NEAR(maps.depth.at(20, 10), 10 + 0.01 * 20.5, 1e-5);
}

TEST(VggtPrediction, NoDepthIsInventedBetweenSurfaces) {
  nn::FeatureMap depth = network_depth(28, 28);
  for (int64_t y = 0; y < 28; ++y) {
    for (int64_t x = 14; x < 28; ++x) depth.at(y, x)[0] = 6;
  }
  const PhotoMaps maps = maps_of_photo(depth, {0.7, 0.7, 0, 0}, 40, 40);
  for (const float z : maps.depth.data) ASSERT_TRUE(std::abs(z - 2) < 1e-5 || std::abs(z - 6) < 1e-5) << z;
}

TEST(VggtPrediction, InvalidDepthStaysWithoutAValue) {
  nn::FeatureMap depth = network_depth(28, 28);
  depth.at(3, 3)[0] = std::numeric_limits<float>::quiet_NaN();
  const PhotoMaps maps = maps_of_photo(depth, {1, 1, 0, 0}, 28, 28);
  EXPECT_EQ(maps.depth.at(3, 3), 0);
  EXPECT_EQ(maps.confidence.at(3, 3), 0);
}

TEST(VggtPrediction, ConfidenceIsRankedOverAllViews) {
  std::vector<PredictedView> views(2);
  for (int v = 0; v < 2; ++v) {
    views[size_t(v)].confidence = ImageF(10, 5, 1);
    for (int i = 0; i < 50; ++i) views[size_t(v)].confidence.data[size_t(i)] = float(1 + 50 * v + i);
  }
  EXPECT_FLOAT_EQ(confidence_at(views, 20), 21);
  EXPECT_FLOAT_EQ(confidence_at({}, 20), 0);
}

}  // namespace
}  // namespace aligngs
