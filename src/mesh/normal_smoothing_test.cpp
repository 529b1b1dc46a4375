#include "mesh/normal_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "mesh/testing/analytic_scenes.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

constexpr Vec3d kHalf{2, 1.3, 2.5};  // of the room, metres

/// A corner of the room with its exact normals.
FusionFrame corner() {
  FusionFrame frame = test::render(test::look_at({0, 0, 0}, {1.8, 0.4, 2.2}, 160, 120, 120), test::room(kHalf));
  frame.normal = camera_normals(frame.depth, frame.camera);
  return frame;
}

ImageF noisy(const ImageF& depth, double sigma) {
  Random random(7);
  ImageF out = depth;
  for (float& z : out.data) z *= static_cast<float>(std::exp(sigma * random.normal()));
  return out;
}

double mean_log_error(const ImageF& depth, const ImageF& truth) {
  double sum = 0;
  for (size_t i = 0; i < truth.data.size(); ++i) sum += std::abs(std::log(double(depth.data[i]) / truth.data[i]));
  return sum / static_cast<double>(truth.data.size());
}

TEST(NormalSmoothing, LeavesAnExactRoomAsItIs) {
  const FusionFrame frame = corner();
  EXPECT_LT(mean_log_error(smooth_along_normals(frame.depth, frame.normal, {}, frame.camera), frame.depth), 3e-4);
}

TEST(NormalSmoothing, TakesNoiseAway) {
  const FusionFrame frame = corner();
  const ImageF start = noisy(frame.depth, 0.004);
  const double before = mean_log_error(start, frame.depth);
  NormalSmoothingOptions options;
  options.outlier = 0.02;
  const double after =
      mean_log_error(smooth_along_normals(start, frame.normal, {}, frame.camera, options), frame.depth);
  EXPECT_LT(after, 0.25 * before) << "an average over some 12 pixels";
}

TEST(NormalSmoothing, OneWrongPixelDoesNotMoveItsNeighbours) {
  const FusionFrame frame = corner();
  ImageF start = frame.depth;
  start.at(80, 60) *= 1.01f;
  const ImageF out = smooth_along_normals(start, frame.normal, {}, frame.camera);
  EXPECT_NEAR(out.at(80, 60) / frame.depth.at(80, 60), 1, 2e-3);
  EXPECT_NEAR(out.at(82, 60) / frame.depth.at(82, 60), 1, 1e-3);
}

TEST(NormalSmoothing, ADepthEdgeStays) {
  FusionFrame frame = corner();
  const FusionFrame before = frame;
  for (int y = 40; y < 80; ++y) {
    for (int x = 60; x < 100; ++x) frame.depth.at(x, y) *= 0.7f;  // something is in front
  }
  const ImageF out = smooth_along_normals(frame.depth, frame.normal, {}, frame.camera);
  EXPECT_LT(mean_log_error(out, frame.depth), 5e-4);
  EXPECT_NEAR(out.at(60, 60) / frame.depth.at(60, 60), 1, 3e-3);
  EXPECT_NEAR(out.at(59, 60) / frame.depth.at(59, 60), 1, 3e-3);
}

TEST(NormalSmoothing, ASurePixelHoldsItsPlace) {
  const FusionFrame frame = corner();
  ImageF start = frame.depth, weight(start.width, start.height, 1, 1.0f);
  for (float& z : start.data) z *= 1.004f;
  for (int x = 0; x < start.width; ++x) {
    for (int y = 55; y < 65; ++y) {
      start.at(x, y) = frame.depth.at(x, y);
      weight.at(x, y) = 100;
    }
  }
  const ImageF out = smooth_along_normals(start, frame.normal, weight, frame.camera);
  EXPECT_NEAR(out.at(80, 60) / frame.depth.at(80, 60), 1, 5e-4);
  EXPECT_LT(out.at(80, 53) / frame.depth.at(80, 53), 1.003) << "what is beside it follows";
}

TEST(NormalSmoothing, PixelsWithoutDepthOrNormalStay) {
  FusionFrame frame = corner();
  frame.depth.at(10, 10) = 0;
  frame.depth.at(11, 10) = std::numeric_limits<float>::quiet_NaN();
  for (int a = 0; a < 3; ++a) frame.normal.at(20, 20, a) = 0;
  frame.normal.at(30, 30, 0) = std::numeric_limits<float>::quiet_NaN();
  const ImageF out = smooth_along_normals(frame.depth, frame.normal, {}, frame.camera);
  EXPECT_EQ(out.at(10, 10), 0);
  EXPECT_EQ(out.at(11, 10), 0);
  EXPECT_NEAR(out.at(20, 20), frame.depth.at(20, 20), 1e-5);
  EXPECT_NEAR(out.at(30, 30), frame.depth.at(30, 30), 1e-5);
  for (const float z : out.data) EXPECT_TRUE(std::isfinite(z));
}

TEST(NormalSmoothing, IsOffWithoutALength) {
  const FusionFrame frame = corner();
  NormalSmoothingOptions off;
  off.length = 0;
  EXPECT_EQ(smooth_along_normals(noisy(frame.depth, 0.01), frame.normal, {}, frame.camera, off).data,
            noisy(frame.depth, 0.01).data);
}

}  // namespace
}  // namespace aligngs
