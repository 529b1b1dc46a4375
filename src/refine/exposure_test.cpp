#include "refine/exposure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/srgb.h"
#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

/// Photos of the same walls, each exposed in its own way.
struct Exposed {
  std::vector<RefineView> photos;
  std::vector<Vec3f> log_gains;

  explicit Exposed(int count) {
    Random random(11);
    for (int i = 0; i < count; ++i) {
      photos.push_back(photo(true_camera(i)));
      Vec3f gain;
      for (int k = 0; k < 3; ++k) gain[k] = static_cast<float>(random.uniform(-0.15, 0.15));
      log_gains.push_back(gain);
      RefineView& view = photos.back();
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const float light = srgb_decode(0.8f * view.match.luma.at(x, y));
          for (int k = 0; k < 3; ++k) view.color.at(x, y, k) = srgb_encode(std::exp(gain[k]) * light);
        }
      }
    }
    Vec3f mean;
    for (const Vec3f& g : log_gains) mean = mean + g * (1.0f / static_cast<float>(count));
    for (Vec3f& g : log_gains) g = g - mean;
  }

  std::vector<Vec3f> estimate(const ExposureSettings& settings = {}) const {
    std::vector<ExposureView> views;
    for (const RefineView& p : photos) views.push_back({&p.match, &p.color, &p.mask});
    ThreadPool pool(2);
    return estimate_log_gains(views, settings, pool);
  }
};

TEST(Exposure, GainsAreFoundUpToTheirMean) {
  const Exposed scene(6);
  const std::vector<Vec3f> found = scene.estimate();
  for (size_t i = 0; i < found.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(found[i][k], scene.log_gains[i][k], 0.015) << "photo " << i << ", channel " << k;
  }
}

TEST(Exposure, TheirMeanIsZero) {
  const std::vector<Vec3f> found = Exposed(5).estimate();
  for (int k = 0; k < 3; ++k) {
    float sum = 0;
    for (const Vec3f& g : found) sum += g[k];
    EXPECT_NEAR(sum, 0, 1e-5);
  }
}

TEST(Exposure, AMaskedPhotoIsLeftAlone) {
  Exposed scene(4);
  scene.photos[2].mask = ImageF(kWidth, kHeight, 1, 0.0f);
  const std::vector<Vec3f> found = scene.estimate();
  EXPECT_NEAR(found[2].x, 0, 1e-6);
  EXPECT_NEAR(found[0].x - found[1].x, scene.log_gains[0].x - scene.log_gains[1].x, 0.02);
}

TEST(Exposure, PhotosThatShareNothingHaveNoGain) {
  Exposed scene(2);
  for (float& z : scene.photos[1].match.depth.data) z = 50;  // another surface, it seems
  for (const Vec3f& g : scene.estimate()) EXPECT_EQ(g.y, 0);
  scene.photos.resize(1);
  EXPECT_EQ(scene.estimate().size(), 1u);
}

TEST(Exposure, ClippedAndDarkPixelsSayNothing) {
  Exposed scene(3);
  for (RefineView& p : scene.photos) std::fill(p.color.data.begin(), p.color.data.end(), 1.0f);
  for (const Vec3f& g : scene.estimate()) EXPECT_EQ(g.x, 0);
}

}  // namespace
}  // namespace aligngs
