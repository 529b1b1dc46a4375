#include "scene/voxel_merge.h"

#include <gtest/gtest.h>

#include <limits>

namespace aligngs {
namespace {

PointCloud three_points() {
  PointCloud cloud;
  cloud.positions = {{0.1f, 0.1f, 0.1f}, {2.5f, 0, 0}, {0.3f, 0.1f, 0.1f}};
  cloud.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cloud.normals = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  return cloud;
}

TEST(VoxelMerge, PointsOfOneCubeBecomeTheirWeightedMean) {
  const VoxelMerge merged = voxel_merge(three_points(), 1.0, {3, 1, 1});
  ASSERT_EQ(merged.cloud.size(), 2u);
  EXPECT_NEAR(merged.cloud.positions[0].x, 0.15, 1e-6);
  EXPECT_NEAR(merged.cloud.colors[0].x, 0.75, 1e-6);
  EXPECT_NEAR(norm(merged.cloud.normals[0]), 1, 1e-6);
  EXPECT_FLOAT_EQ(merged.weights[0], 4);
  EXPECT_EQ(merged.cell_of, (std::vector<uint32_t>{0, 1, 0}));
}

TEST(VoxelMerge, NegativeCoordinatesDoNotShareTheCubeAtTheOrigin) {
  PointCloud cloud;
  cloud.positions = {{-0.1f, 0, 0}, {0.1f, 0, 0}};
  cloud.colors.resize(2);
  EXPECT_EQ(voxel_merge(cloud, 1.0).cloud.size(), 2u);
}

TEST(VoxelMerge, InvalidAndWeightlessPointsAreDropped) {
  PointCloud cloud = three_points();
  cloud.positions[1].x = std::numeric_limits<float>::quiet_NaN();
  const VoxelMerge merged = voxel_merge(cloud, 1.0, {1, 1, 0});
  ASSERT_EQ(merged.cloud.size(), 1u);
  EXPECT_EQ(merged.cell_of[1], VoxelMerge::kDropped);
  EXPECT_EQ(merged.cell_of[2], VoxelMerge::kDropped);
}

TEST(VoxelMerge, WithoutAnEdgeEveryPointStaysInOrder) {
  const VoxelMerge merged = voxel_merge(three_points(), 0);
  ASSERT_EQ(merged.cloud.size(), 3u);
  EXPECT_FLOAT_EQ(merged.cloud.positions[1].x, 2.5f);
}

TEST(VoxelMerge, FarOutliersDoNotOverflow) {
  PointCloud cloud = three_points();
  cloud.positions[1].x = 1e30f;
  EXPECT_EQ(voxel_merge(cloud, 1e-3).cloud.size(), 3u);
}

}  // namespace
}  // namespace aligngs
