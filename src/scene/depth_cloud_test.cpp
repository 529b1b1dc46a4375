#include "scene/depth_cloud.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr double kWall = 2;  // depth of the wall z = 2 that all cameras look at

/// Cameras side by side looking along z at a wall.
struct Rig {
  std::vector<ImageF> depth, color;
  std::vector<DepthCloudView> views;
};

Rig wall_rig(int count) {
  Rig rig;
  rig.depth.assign(count, ImageF(32, 24, 1, static_cast<float>(kWall)));
  rig.color.assign(count, ImageF(32, 24, 3, 0.5f));
  for (int i = 0; i < count; ++i) {
    DepthCloudView view;
    view.camera.width = 32;
    view.camera.height = 24;
    view.camera.fx = view.camera.fy = 32;
    view.camera.cx = 16;
    view.camera.cy = 12;
    view.camera.world_to_camera.translation = {-0.2 * i, 0, 0};
    view.depth = &rig.depth[i];
    view.color = &rig.color[i];
    rig.views.push_back(view);
  }
  return rig;
}

TEST(DepthCloud, AWallBecomesPointsOnItWithNormalsToTheCameras) {
  const Rig rig = wall_rig(3);
  ThreadPool pool(2);
  const DepthCloud fused = fuse_depth_cloud(rig.views, {}, pool);
  EXPECT_NEAR(fused.voxel, 1.5 * kWall / 32, 1e-6);
  ASSERT_GT(fused.cloud.size(), 300u);
  ASSERT_TRUE(fused.cloud.has_normals());
  for (size_t i = 0; i < fused.cloud.size(); ++i) {
    ASSERT_NEAR(fused.cloud.positions[i].z, kWall, 1e-5);
    ASSERT_NEAR(fused.cloud.normals[i].z, -1, 1e-4);
  }
}

TEST(DepthCloud, PointsThatOnlyOneViewSeesAreFlagged) {
  const Rig rig = wall_rig(2);
  ThreadPool pool(1);
  const DepthCloud fused = fuse_depth_cloud(rig.views, {}, pool);
  bool single = false, confirmed = false;
  for (size_t i = 0; i < fused.cloud.size(); ++i) {
    if (fused.cloud.positions[i].x < -0.85) single |= fused.views[i] == 1;  // left of the second camera's image
    if (std::abs(fused.cloud.positions[i].x) < 0.5) confirmed |= fused.views[i] == 2;
  }
  EXPECT_TRUE(single);
  EXPECT_TRUE(confirmed);
}

TEST(DepthCloud, SingleViewPointsCanBeLeftOut) {
  const Rig rig = wall_rig(1);
  ThreadPool pool(1);
  DepthCloudOptions options;
  EXPECT_GT(fuse_depth_cloud(rig.views, options, pool).cloud.size(), 0u);
  options.keep_single_view = false;
  EXPECT_EQ(fuse_depth_cloud(rig.views, options, pool).cloud.size(), 0u);
}

TEST(DepthCloud, ASurfaceThatOtherViewsSeeThroughIsDropped) {
  Rig rig = wall_rig(3);
  for (int y = 8; y < 16; ++y)
    for (int x = 12; x < 20; ++x) rig.depth[0].at(x, y) = 1;  // a ghost in one view only
  ThreadPool pool(1);
  for (const Vec3f& p : fuse_depth_cloud(rig.views, {}, pool).cloud.positions) ASSERT_NEAR(p.z, kWall, 1e-5);
}

TEST(DepthCloud, ConfidenceWeighsAndExcludes) {
  Rig rig = wall_rig(1);
  ImageF confidence(32, 24, 1, 0.5f);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 16; ++x) confidence.at(x, y) = 0.01f;
  rig.views[0].confidence = &confidence;
  DepthCloudOptions options;
  options.voxel = 1e-6;
  ThreadPool pool(1);
  const DepthCloud fused = fuse_depth_cloud(rig.views, options, pool);
  ASSERT_EQ(fused.cloud.size(), 16u * 24);
  for (float weight : fused.weights) ASSERT_FLOAT_EQ(weight, 0.125f);
}

TEST(DepthCloud, TheResultDoesNotDependOnTheNumberOfThreads) {
  const Rig rig = wall_rig(4);
  ThreadPool one(1), three(3);
  const DepthCloud a = fuse_depth_cloud(rig.views, {}, one), b = fuse_depth_cloud(rig.views, {}, three);
  ASSERT_EQ(a.cloud.size(), b.cloud.size());
  for (size_t i = 0; i < a.cloud.size(); ++i) {
    ASSERT_EQ(a.cloud.positions[i].x, b.cloud.positions[i].x);
    ASSERT_EQ(a.weights[i], b.weights[i]);
  }
}

TEST(DepthCloud, TheAutomaticVoxelGrowsUntilTheCloudIsSmallEnough) {
  const Rig rig = wall_rig(2);
  ThreadPool pool(1);
  DepthCloudOptions options;
  options.max_points = 100;
  const DepthCloud fused = fuse_depth_cloud(rig.views, options, pool);
  EXPECT_LE(fused.cloud.size(), 100u);
  EXPECT_GT(fused.cloud.size(), 50u);
}

TEST(DepthCloud, MapsWithoutDepthGiveAnEmptyCloud) {
  Rig rig = wall_rig(2);
  for (ImageF& depth : rig.depth) depth = ImageF(32, 24, 1);
  ThreadPool pool(1);
  EXPECT_EQ(fuse_depth_cloud(rig.views, {}, pool).cloud.size(), 0u);
  EXPECT_EQ(fuse_depth_cloud({}, {}, pool).cloud.size(), 0u);
}

TEST(DepthCloud, AMapOfAnotherSizeIsRefused) {
  Rig rig = wall_rig(1);
  rig.depth[0] = ImageF(5, 5, 1);
  ThreadPool pool(1);
  EXPECT_THROW(fuse_depth_cloud(rig.views, {}, pool), Error);
}

}  // namespace
}  // namespace aligngs
