#include "nn/vggt_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "nn/vggt.h"

namespace aligngs::nn {
namespace {

TEST(VggtPose, RotationsAndQuaternionsAreInverse) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    std::array<double, 4> q{};
    double length = 0;
    for (double& v : q) v = random.normal(), length += v * v;
    for (double& v : q) v /= std::sqrt(length) * (q[3] < 0 ? -1 : 1);
    if (q[3] < 0) {
      for (double& v : q) v = -v;
    }
    const std::array<double, 4> back = xyzw_from_rotation(rotation_from_xyzw(q));
    for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(back[k], q[k], 1e-9);
  }
}

TEST(VggtPose, TheLengthOfAQuaternionDoesNotMatter) {
  const auto a = rotation_from_xyzw({0.1, -0.2, 0.3, 0.9}), b = rotation_from_xyzw({0.2, -0.4, 0.6, 1.8});
  for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
}

TEST(VggtPose, AQuaternionOfLengthZeroIsNoRotation) {
  EXPECT_THAT(rotation_from_xyzw({0, 0, 0, 0}), testing::ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
}

TEST(VggtPose, FocalLengthsFollowFromTheFieldsOfView) {
  const double right_angle = std::acos(-1.0) / 2;
  const VggtCamera camera = decode_pose({1, 2, 3, 0, 0, 0, 1, float(right_angle), float(right_angle)}, 200, 100);
  EXPECT_NEAR(camera.fx, 100, 1e-4);
  EXPECT_NEAR(camera.fy, 50, 1e-4);
  EXPECT_THAT(camera.translation, testing::ElementsAre(1, 2, 3));
}

TEST(VggtPose, AFieldOfViewOfZeroKeepsTheFocalLengthFinite) {
  const VggtCamera camera = decode_pose({0, 0, 0, 0, 0, 0, 1, 0, 0}, 518, 392);
  EXPECT_NEAR(camera.fx, 518 / 1e-3, 1);  // that of a thousandth of a radian
  EXPECT_NEAR(camera.fy, 392 / 1e-3, 1);
}

TEST(VggtPose, UnprojectedDepthLiesBehindThePixel) {
  VggtCamera camera;
  camera.rotation = {0, 0, 1, 0, 1, 0, -1, 0, 0};  // a quarter turn about y
  camera.translation = {0, 0, 5};
  camera.fx = camera.fy = 2;
  camera.cx = camera.cy = 1;
  FeatureMap depth(3, 3, 2);
  for (float& v : depth.data) v = 7;
  const FeatureMap points = unproject_depth(depth, camera);
  const float* centre = points.at(1, 1);  // in the camera (0, 0, 7)
  EXPECT_NEAR(centre[0], -2, 1e-6);       // R^T (0, 0, 7 - 5)
  EXPECT_NEAR(centre[1], 0, 1e-6);
  EXPECT_NEAR(centre[2], 0, 1e-6);
}

}  // namespace
}  // namespace aligngs::nn
