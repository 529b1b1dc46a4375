#include "nn/da3/ray_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "nn/vggt_pose.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kWidth = 504, kHeight = 378;

NetworkCamera camera_at(double cx, double cy) {
  NetworkCamera camera;
  camera.rotation = rotation_from_xyzw({0.1, -0.2, 0.05, 0.95});
  camera.translation = {0.4, -0.3, 1.2};
  camera.fx = 400;
  camera.fy = 420;
  camera.cx = cx;
  camera.cy = cy;
  return camera;
}

/// The rays of a camera, some of them wild.
FeatureMap rays_of(const NetworkCamera& c, double wild = 0) {
  FeatureMap rays(27, 36, 7);
  Random random(1);
  for (int64_t y = 0; y < rays.height; ++y) {
    for (int64_t x = 0; x < rays.width; ++x) {
      const double u = (double(x) + 0.5) * kWidth / 36, v = (double(y) + 0.5) * kHeight / 27;
      const double d[3] = {(u - c.cx) / c.fx, (v - c.cy) / c.fy, 1};
      float* const ray = rays.at(y, x);
      for (size_t i = 0; i < 3; ++i) {
        double direction = 0, origin = 0;
        for (size_t k = 0; k < 3; ++k) {
          direction += c.rotation[3 * k + i] * d[k];
          origin -= c.rotation[3 * k + i] * c.translation[k];
        }
        ray[i] = float(random.chance(wild) ? random.normal() : 2 * direction);
        ray[3 + i] = float(origin);
      }
      ray[6] = float(1 + random.uniform());
    }
  }
  return rays;
}

void expect_camera(const NetworkCamera& a, const NetworkCamera& b, double tolerance) {
  for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(a.rotation[i], b.rotation[i], tolerance);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.translation[i], b.translation[i], tolerance);
  EXPECT_NEAR(a.fx, b.fx, 500 * tolerance);
  EXPECT_NEAR(a.fy, b.fy, 500 * tolerance);
  EXPECT_NEAR(a.cx, b.cx, 500 * tolerance);
  EXPECT_NEAR(a.cy, b.cy, 500 * tolerance);
}

TEST(RayPose, FindsACameraWhereverItsPrincipalPointLies) {
  for (const auto& [cx, cy] : {std::pair(252.0, 189.0), std::pair(290.0, 160.0)}) {
    const RayPose pose = pose_from_rays(rays_of(camera_at(cx, cy)), kWidth, kHeight);
    expect_camera(pose.camera, camera_at(cx, cy), 1e-5);
    EXPECT_EQ(pose.inliers, 27u * 36u);
  }
}

TEST(RayPose, ThePublishedWayIsRightForACentredPrincipalPointOnly) {
  RayPoseOptions published;
  published.decomposition = RayDecomposition::kPublished;
  const NetworkCamera centred = camera_at(252, 189), off = camera_at(290, 189);
  expect_camera(pose_from_rays(rays_of(centred), kWidth, kHeight, published).camera, centred, 1e-5);
  const RayPose wrong = pose_from_rays(rays_of(off), kWidth, kHeight, published);
  EXPECT_GT(std::abs(wrong.camera.cx - off.cx), 10);
}

TEST(RayPose, WildRaysDoNotMoveIt) {
  const NetworkCamera camera = camera_at(270, 180);
  const RayPose pose = pose_from_rays(rays_of(camera, 0.05), kWidth, kHeight);
  expect_camera(pose.camera, camera, 2e-2);
  EXPECT_LT(pose.inliers, 27u * 36u);
}

TEST(RayPose, DrawsAreThoseOfTheirSeedAndDistinct) {
  RayPoseOptions options;
  const RayDraws a = draw_rays(972, options), b = draw_rays(972, options);
  EXPECT_EQ(a, b);
  options.seed = 2;
  EXPECT_NE(draw_rays(972, options), a);
  EXPECT_EQ(ray_candidates(972), 291);
  for (auto draw : a) {
    std::sort(draw.begin(), draw.end());
    EXPECT_EQ(std::unique(draw.begin(), draw.end()), draw.end());
    EXPECT_LT(draw.back(), 291);
  }
}

TEST(RayPose, RaysOfNoCameraAreRefused) {
  EXPECT_THROW(pose_from_rays(FeatureMap(2, 3, 7), kWidth, kHeight), Error);
  FeatureMap flat(8, 8, 7);  // no direction at all
  EXPECT_THROW(pose_from_rays(flat, kWidth, kHeight), Error);
}

}  // namespace
}  // namespace aligngs::nn
