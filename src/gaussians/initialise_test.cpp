#include "gaussians/initialise.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"

namespace aligngs {
namespace {

/// A grid of 5 x 5 points on the plane z = 0, one unit apart.
PointCloud grid() {
  PointCloud cloud;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      cloud.positions.push_back({static_cast<float>(x), static_cast<float>(y), 0});
      cloud.colors.push_back({0.25f, 0.5f, 1});
      cloud.normals.push_back({1, 0, 0});
    }
  }
  return cloud;
}

PointCloud cloud_of(std::vector<Vec3f> positions) {
  PointCloud cloud;
  cloud.positions = std::move(positions);
  cloud.colors.assign(cloud.positions.size(), {0.5f, 0.5f, 0.5f});
  return cloud;
}

TEST(InitialiseGaussians, TheScaleIsTheDistanceToTheNeighbours) {
  const GaussianModel model = initialise_gaussians(grid(), {});
  EXPECT_NEAR(model.log_scales[3 * 12], 0, 1e-6);                 // centre: three neighbours at distance 1
  EXPECT_NEAR(std::exp(2 * model.log_scales[0]), 4.0 / 3, 1e-5);  // corner: squared distances 1, 1, 2
}

TEST(InitialiseGaussians, ColourOpacityAndSemanticsHaveTheirStart) {
  InitialiseOptions options;
  options.semantic_channels = 7;
  const GaussianModel model = initialise_gaussians(grid(), options);
  EXPECT_EQ(model.sh_degree, 0);
  EXPECT_NEAR(0.5 + kSh0 * model.sh[0], 0.25, 1e-6);
  EXPECT_NEAR(0.5 + kSh0 * model.sh[2], 1, 1e-6);
  EXPECT_EQ(model.sh[3], 0);
  EXPECT_NEAR(1 / (1 + std::exp(-model.opacity_logits[3])), 0.1, 1e-6);
  ASSERT_EQ(model.semantics.size(), 25u * 7);
  for (float s : model.semantics) ASSERT_EQ(s, 0);
}

TEST(InitialiseGaussians, TheThinAxisLiesAlongTheNormal) {
  InitialiseOptions options;
  options.flat_ratio = 0.1f;
  const GaussianModel model = initialise_gaussians(grid(), options);
  const Quaternionf q{model.rotations[0], model.rotations[1], model.rotations[2], model.rotations[3]};
  EXPECT_NEAR(std::abs(rotation_matrix(q).column(2).x), 1, 1e-6);
  EXPECT_NEAR(model.log_scales[2] - model.log_scales[0], std::log(0.1), 1e-5);
}

TEST(InitialiseGaussians, WithoutNormalsGaussiansAreRound) {
  InitialiseOptions options;
  options.flat_ratio = 0.1f;
  options.use_normals = false;
  const GaussianModel model = initialise_gaussians(grid(), options);
  EXPECT_EQ(model.log_scales[0], model.log_scales[2]);
  EXPECT_EQ(model.rotations[0], 1);
}

TEST(InitialiseGaussians, ScalesFollowTheSizeOfTheScene) {
  PointCloud small = grid();
  for (Vec3f& p : small.positions) p *= 0.37f;
  const GaussianModel a = initialise_gaussians(grid(), {}), b = initialise_gaussians(small, {});
  for (size_t i = 0; i < a.log_scales.size(); ++i) ASSERT_NEAR(b.log_scales[i] - a.log_scales[i], std::log(0.37), 1e-5);
}

TEST(InitialiseGaussians, TheLargestScaleCanBeLimited) {
  InitialiseOptions options;
  options.scale_max = 0.5f;
  for (float s : initialise_gaussians(grid(), options).log_scales) ASSERT_LE(s, std::log(0.5f));
}

TEST(InitialiseGaussians, AnEmptyCloudGivesAnEmptyModel) { EXPECT_EQ(initialise_gaussians({}, {}).size(), 0u); }

TEST(InitialiseGaussians, OnePointHasADefinedScale) {
  EXPECT_NEAR(std::exp(initialise_gaussians(cloud_of({{1, 2, 3}}), {}).log_scales[0]), 0.01, 1e-6);
}

TEST(InitialiseGaussians, TwoAndThreePointsUseTheNeighboursThereAre) {
  EXPECT_NEAR(initialise_gaussians(cloud_of({{0, 0, 0}, {2, 0, 0}}), {}).log_scales[0], std::log(2.0), 1e-6);
  const GaussianModel three = initialise_gaussians(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 3, 0}}), {});
  EXPECT_NEAR(std::exp(2 * three.log_scales[0]), 5, 1e-5);  // squared distances 1 and 9
}

TEST(InitialiseGaussians, DuplicatesHaveASmallButPositiveScale) {
  PointCloud cloud = grid();
  for (int i = 0; i < 5; ++i) {
    cloud.positions.push_back(cloud.positions[0]);
    cloud.colors.push_back(cloud.colors[0]);
    cloud.normals.push_back(cloud.normals[0]);
  }
  const GaussianModel model = initialise_gaussians(cloud, {});
  EXPECT_NEAR(std::exp(model.log_scales[0]), 0.01, 1e-4);
}

TEST(InitialiseGaussians, ACloudInOnePlaceHasADefinedScale) {
  const GaussianModel model = initialise_gaussians(cloud_of(std::vector<Vec3f>(1000, Vec3f{1, 1, 1})), {});
  for (float s : model.log_scales) ASSERT_NEAR(std::exp(s), 0.01, 1e-6);
}

TEST(InitialiseGaussians, NonFinitePointsAndBadOptionsAreRefused) {
  EXPECT_THROW(initialise_gaussians(cloud_of({{std::numeric_limits<float>::infinity(), 0, 0}}), {}), Error);
  InitialiseOptions options;
  options.flat_ratio = 0;
  EXPECT_THROW(initialise_gaussians(grid(), options), Error);
}

TEST(VoxelThin, KeepsOnePointPerCube) {
  const PointCloud thin = voxel_thin(grid(), 2.0);
  EXPECT_EQ(thin.size(), 9u);  // coordinates 0-1, 2-3, 4
  EXPECT_TRUE(thin.has_normals());
}

}  // namespace
}  // namespace aligngs
