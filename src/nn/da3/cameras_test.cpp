#include "nn/da3/cameras.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace aligngs::nn {
namespace {

NetworkCamera random_camera(Random& random) {
  NetworkCamera camera;
  std::array<double, 4> q{};
  for (double& v : q) v = random.normal();
  camera.rotation = rotation_from_xyzw(q);
  for (double& v : camera.translation) v = random.normal();
  camera.fx = random.uniform(300, 500);
  camera.fy = random.uniform(300, 500);
  camera.cx = 252;
  camera.cy = 189;
  return camera;
}

std::vector<NetworkCamera> random_cameras(size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<NetworkCamera> cameras(count);
  for (NetworkCamera& camera : cameras) camera = random_camera(random);
  return cameras;
}

void expect_near(const NetworkCamera& a, const NetworkCamera& b, double tolerance) {
  for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(a.rotation[i], b.rotation[i], tolerance);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.translation[i], b.translation[i], tolerance);
}

TEST(Da3Cameras, EncodingAndDecodingAreInverse) {
  for (const NetworkCamera& camera : random_cameras(50, 1)) {
    const NetworkCamera back = decode_da3_camera(encode_da3_camera(camera, 504, 378), 504, 378);
    expect_near(back, camera, 2e-6);
    EXPECT_NEAR(back.fx, camera.fx, 1e-3);
    EXPECT_NEAR(back.fy, camera.fy, 1e-3);
  }
}

TEST(Da3Cameras, TheEncodingIsThatOfTheCameraInTheWorld) {
  NetworkCamera camera;
  camera.rotation = {0, 0, 1, 0, 1, 0, -1, 0, 0};
  camera.translation = {0, 0, 5};
  camera.fx = 252;
  camera.fy = 189;
  const PoseEncoding e = encode_da3_camera(camera, 504, 378);
  EXPECT_NEAR(e[0], 5, 1e-6);  // -R^T t
  EXPECT_NEAR(e[2], 0, 1e-6);
  EXPECT_NEAR(e[7], std::acos(-1.0) / 2, 1e-6);  // height before width
}

TEST(Da3Cameras, AFieldOfViewOfZeroIsFiniteAndImplausible) {
  const NetworkCamera camera = decode_da3_camera({0, 0, 0, 0, 0, 0, 1, 0, 1}, 504, 378);
  EXPECT_TRUE(std::isfinite(camera.fy));
  EXPECT_FALSE(da3_camera_is_plausible(camera, 504, 378));
  EXPECT_TRUE(da3_camera_is_plausible(decode_da3_camera({0, 0, 0, 0, 0, 0, 1, 1, 1}, 504, 378), 504, 378));
  EXPECT_FALSE(da3_camera_is_plausible(decode_da3_camera({0, 0, 0, 0, 0, 0, 1, 3.3f, 1}, 504, 378), 504, 378));
}

TEST(Da3Cameras, NormalisedCamerasBeginAtTheOriginAndForgetTheirScale) {
  std::vector<NetworkCamera> cameras = random_cameras(5, 2);
  const std::vector<NetworkCamera> a = normalised_cameras(cameras);
  expect_near(a[0], {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, 1e-12);
  for (NetworkCamera& camera : cameras) {
    for (double& t : camera.translation) t *= 7;
  }
  const std::vector<NetworkCamera> b = normalised_cameras(cameras);
  for (size_t i = 0; i < a.size(); ++i) expect_near(a[i], b[i], 1e-9);
}

TEST(Da3Cameras, OneCameraIsNotDividedByZero) {
  const std::vector<NetworkCamera> one = normalised_cameras(random_cameras(1, 3));
  EXPECT_NEAR(one[0].translation[0], 0, 1e-12);
}

TEST(Da3Cameras, AlignmentFindsTheScaleBetweenTheFrames) {
  const std::vector<NetworkCamera> given = random_cameras(4, 4);
  std::vector<NetworkCamera> predicted = normalised_cameras(given);  // another frame, another scale
  const CameraAlignment fit = align_given_cameras(given, predicted);
  EXPECT_TRUE(fit.well_posed);
  EXPECT_NEAR(fit.residual, 0, 1e-9);
  for (size_t i = 0; i < given.size(); ++i) expect_near(fit.cameras[i], predicted[i], 1e-9);
}

TEST(Da3Cameras, TwoCamerasAreAlignedByTheirRotations) {
  const std::vector<NetworkCamera> given = random_cameras(2, 5);
  const std::vector<NetworkCamera> predicted = normalised_cameras(given);
  const CameraAlignment fit = align_given_cameras(given, predicted);
  EXPECT_FALSE(fit.well_posed);
  for (size_t i = 0; i < given.size(); ++i) expect_near(fit.cameras[i], predicted[i], 1e-6);
}

}  // namespace
}  // namespace aligngs::nn
