// Free-space pruning and the alignment of prior depth, on hand-made maps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "train/free_space.h"
#include "train/prior_alignment.h"

namespace aligngs {
namespace {

/// A camera at the given x, looking along +z.
Camera small_camera_at(double x) {
  Camera c;
  c.width = 20;
  c.height = 20;
  c.fx = c.fy = 20;
  c.cx = c.cy = 10;
  c.world_to_camera.translation = {-x, 0, 0};
  return c;
}

GaussianModel model_at(const std::vector<Vec3f>& positions) {
  GaussianModel model;
  model.resize(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    for (int k = 0; k < 3; ++k) model.positions[3 * i + static_cast<size_t>(k)] = positions[i][k];
  }
  return model;
}

class FreeSpace : public testing::Test {
 protected:
  ThreadPool pool_{2};
  ImageF wall_{20, 20, 1, 2.0f};  // a wall at z = 2
  ImageF none_{20, 20, 1, 0.0f};

  std::vector<uint8_t> keep(const std::vector<Vec3f>& positions, const ImageF* prior, const ImageF* rendered,
                            const ImageF* weight = nullptr) {
    std::vector<FreeSpaceView> views;
    for (const double x : {-0.1, 0.0, 0.1}) {
      FreeSpaceView v;
      v.camera = small_camera_at(x);
      v.prior_depth = prior;
      v.prior_weight = weight;
      v.median_depth = rendered;
      views.push_back(v);
    }
    FreeSpaceRule rule;
    rule.prior_offset = 0.02;
    return free_space_keep(model_at(positions), views, rule, pool_);
  }
};

TEST_F(FreeSpace, RemovesWhatFloatsInFrontOfThePrior) {
  // 4 % + 2 cm in front of 2 m is 1.90 m.
  EXPECT_EQ(keep({{0, 0, 1.0f}, {0, 0, 1.89f}, {0, 0, 1.91f}, {0, 0, 2.0f}}, &wall_, &none_),
            (std::vector<uint8_t>{0, 0, 1, 1}));
}

TEST_F(FreeSpace, RemovesWhatFloatsInFrontOfTheRenderedSurface) {
  EXPECT_EQ(keep({{0, 0, 1.0f}, {0, 0, 1.89f}, {0, 0, 1.95f}}, nullptr, &wall_), (std::vector<uint8_t>{0, 0, 1}));
}

TEST_F(FreeSpace, SurfaceThatTwoViewsSupportStays) {
  ImageF closer(20, 20, 1, 1.5f);  // the prior says 2 m, but every view renders a surface at 1.5 m
  EXPECT_EQ(keep({{0, 0, 1.5f}, {0, 0, 1.0f}}, &wall_, &closer), (std::vector<uint8_t>{1, 0}));
}

TEST_F(FreeSpace, UnsurePriorCarvesNothing) {
  ImageF unsure(20, 20, 1, 0.2f);
  EXPECT_EQ(keep({{0, 0, 1.0f}}, &wall_, &none_, &unsure), (std::vector<uint8_t>{1}));
}

TEST_F(FreeSpace, UnseenAndBehindTheCameraStay) {
  EXPECT_EQ(keep({{50, 0, 1.0f}, {0, 0, -1.0f}}, &wall_, &wall_), (std::vector<uint8_t>{1, 1}));
}

TEST_F(FreeSpace, NonFiniteInputIsNoEvidence) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ImageF broken(20, 20, 1, nan);
  EXPECT_EQ(keep({{0, 0, 1.0f}, {nan, 0, 1.0f}}, &broken, &broken), (std::vector<uint8_t>{1, 1}));
}

TEST_F(FreeSpace, EmptyModelGivesNoFlags) { EXPECT_TRUE(keep({}, &wall_, &wall_).empty()); }

ImageF ramp(double scale) {
  ImageF depth(20, 20, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) depth.at(x, y) = static_cast<float>(scale * (1.0 + 0.02 * x + 0.01 * y));
  return depth;
}

TEST(PriorAlignment, FindsTheScaleOfAView) {
  EXPECT_NEAR(*align_prior_to_depth(ramp(1), {}, ramp(1.02), {}), 1.02, 1e-5);
  EXPECT_NEAR(*align_prior_to_depth(ramp(1), {}, ramp(0.99), {}), 0.99, 1e-5);
}

TEST(PriorAlignment, IsClampedToThreePercent) {
  EXPECT_NEAR(*align_prior_to_depth(ramp(1), {}, ramp(1.1), {}), 1.03, 1e-6);
  EXPECT_NEAR(*align_prior_to_depth(ramp(1), {}, ramp(0.9), {}), 0.97, 1e-6);
}

TEST(PriorAlignment, IgnoresOtherSurfacesAndHoles) {
  ImageF reference = ramp(1.01);
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 6; ++y) reference.at(x, y) = 30;  // occluded
    reference.at(x, 7) = 0;
    reference.at(x, 8) = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_NEAR(*align_prior_to_depth(ramp(1), {}, reference, {}), 1.01, 1e-5);
}

TEST(PriorAlignment, TooFewSamplesDetermineNothing) {
  ImageF weight(20, 20, 1, 0.0f);
  weight.at(3, 3) = 1;
  EXPECT_FALSE(align_prior_to_depth(ramp(1), weight, ramp(1.02), {}).has_value());
  EXPECT_FALSE(align_prior_to_depth(ramp(1), {}, ImageF(5, 5, 1, 1.0f), {}).has_value());
  EXPECT_FALSE(align_prior_to_points(ramp(1), {}, small_camera_at(0), {}, {}).has_value());
}

TEST(PriorAlignment, FindsTheScaleFromPoints) {
  const Camera camera = small_camera_at(0.3);
  const ImageF prior = ramp(1);
  PointCloud cloud;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const Vec3d p = camera.unproject(x + 0.5, y + 0.5, 0.98 * prior.at(x, y));
      cloud.positions.push_back(p.cast<float>());
    }
  }
  EXPECT_NEAR(*align_prior_to_points(prior, {}, camera, cloud, {}), 0.98, 1e-5);
}

}  // namespace
}  // namespace aligngs
