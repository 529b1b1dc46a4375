// Three photos of a wall with a texture on its left half and nothing on its right half.
#include "synth/sfm_cloud.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kWallDepth = 3;  // metres, the plane z = 3

/// Grey of the wall at a world position: blotches for x < 0, plain for x >= 0.
double wall_grey(double x, double y) {
  return x >= 0 ? 0.8 : 0.5 + 0.25 * std::sin(9 * x + 2 * std::sin(5 * y)) * std::cos(8 * y + 1.5 * std::sin(7 * x));
}

struct WallPhotos {
  std::vector<RenderedView> truth;
  std::vector<Image<uint8_t>> photos;
  std::vector<SfmView> views;

  explicit WallPhotos(int count, double camera_error = 0) : truth(count), photos(count) {
    for (int v = 0; v < count; ++v) {
      Camera camera;
      camera.width = kWidth;
      camera.height = kHeight;
      camera.fx = camera.fy = 80;
      camera.cx = kWidth / 2.0;
      camera.cy = kHeight / 2.0;
      camera.world_to_camera.translation = {-0.3 * v, 0, 0};
      RenderedView& view = truth[v];
      view.camera = camera;
      view.depth = ImageF(kWidth, kHeight, 1, static_cast<float>(kWallDepth));
      photos[v] = Image<uint8_t>(kWidth, kHeight, 3);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Vec3d p = camera.unproject(x + 0.5, y + 0.5, kWallDepth);
          for (int c = 0; c < 3; ++c) photos[v].at(x, y, c) = static_cast<uint8_t>(255 * wall_grey(p.x, p.y));
        }
      }
      camera.world_to_camera.translation.x += v == 1 ? camera_error : 0;
      views.push_back({&truth[v], &photos[v], camera});
    }
  }
};

TEST(SfmCloud, PointsLieOnTheTexturedPartOfTheWall) {
  const WallPhotos wall(3);
  const PointCloud cloud = simulate_sfm_cloud(wall.views, {}, Random(1));
  ASSERT_GT(cloud.size(), 50u);
  EXPECT_EQ(cloud.colors.size(), cloud.size());
  double mean = 0;
  for (const Vec3f& p : cloud.positions) {
    EXPECT_LT(p.x, 0.15f) << "nothing to match on the bare half";
    mean += p.z / static_cast<double>(cloud.size());
  }
  EXPECT_NEAR(mean, kWallDepth, 0.05);
}

TEST(SfmCloud, WithoutObservationNoisePositionsAreExact) {
  const WallPhotos wall(3);
  SfmSettings settings;
  settings.pixel_noise = 0;
  for (const Vec3f& p : simulate_sfm_cloud(wall.views, settings, Random(1)).positions)
    EXPECT_NEAR(p.z, kWallDepth, 1e-4);
}

TEST(SfmCloud, ErrorsOfTheCamerasAreInThePoints) {
  const WallPhotos wall(2, 0.02);  // the second camera is believed to be 2 cm off: its baseline is 28 cm, not 30
  SfmSettings settings;
  settings.pixel_noise = 0;
  const PointCloud cloud = simulate_sfm_cloud(wall.views, settings, Random(1));
  ASSERT_GT(cloud.size(), 20u);
  for (const Vec3f& p : cloud.positions) EXPECT_NEAR(p.z, kWallDepth * 0.28 / 0.30, 0.02);
}

TEST(SfmCloud, OnePhotoGivesNothing) {
  const WallPhotos wall(1);
  EXPECT_EQ(simulate_sfm_cloud(wall.views, {}, Random(1)).size(), 0u);
}

TEST(SfmCloud, IsTheSameForTheSameSeed) {
  const WallPhotos wall(3);
  const PointCloud a = simulate_sfm_cloud(wall.views, {}, Random(4)), b = simulate_sfm_cloud(wall.views, {}, Random(4));
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a.positions[i].z, b.positions[i].z);
}

}  // namespace
}  // namespace aligngs
