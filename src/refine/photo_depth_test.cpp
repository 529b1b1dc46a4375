#include "refine/photo_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr double kGrain = 0.3;  // grain of the walls: without any, places look alike

/// Photos of the corner with true cameras and no depth, and some points of its walls, as structure from motion finds
/// them.
struct BarePhotos {
  std::vector<MatchView> views;
  std::vector<ImageF> truth;
  std::vector<Vec3f> points;

  explicit BarePhotos(int count) {
    for (int i = 0; i < count; ++i) {
      RefineView view = photo(true_camera(i), kGrain);
      truth.push_back(std::move(view.match.depth));
      view.match.depth = {};
      for (int y = 5; y < kHeight; y += 20) {
        for (int x = 5; x < kWidth; x += 20)
          points.push_back(
              view.match.camera.unproject(x + 0.5, y + 0.5, static_cast<double>(truth.back().at(x, y))).cast<float>());
      }
      views.push_back(std::move(view.match));
    }
  }

  /// Median relative error of view i's depth over its pixels that are certain, or over the others.
  double error(size_t i, const PhotoDepth& found, bool certain) const {
    std::vector<double> errors;
    for (size_t p = 0; p < found.depth.pixels(); ++p) {
      if ((found.certainty.data[p] > 0) == certain)
        errors.push_back(std::abs(static_cast<double>(found.depth.data[p] / truth[i].data[p]) - 1));
    }
    return median_of(std::move(errors));
  }
};

TEST(PhotoDepth, FindsTheWallsWithoutAnyPrior) {
  const BarePhotos bare(6);
  ThreadPool pool(2);
  const std::vector<PhotoDepth> depths = photo_depth(bare.views, bare.points, {}, pool);
  for (size_t i = 1; i + 1 < depths.size(); ++i) {
    EXPECT_GT(depths[i].measured, 0.5) << i;
    EXPECT_LT(bare.error(i, depths[i], true), 0.01) << i;
    // where the border or another wall hides it: between its neighbours
    EXPECT_LT(bare.error(i, depths[i], false), 0.06) << i;
  }
}

TEST(PhotoDepth, IsSearchedCoarselyInLargePhotos) {
  const BarePhotos bare(4);
  PhotoDepthSettings settings;
  settings.coarse_width = kWidth / 2;
  ThreadPool pool(2);
  const std::vector<PhotoDepth> depths = photo_depth(bare.views, bare.points, settings, pool);
  EXPECT_EQ(depths[1].depth.width, kWidth);
  EXPECT_EQ(depths[1].certainty.height, kHeight);
  EXPECT_LT(bare.error(1, depths[1], true), 0.01);
  settings.fine_passes = 0;
  const std::vector<PhotoDepth> coarse = photo_depth(bare.views, bare.points, settings, pool);
  EXPECT_EQ(coarse[1].depth.width, kWidth);
  EXPECT_LT(bare.error(1, coarse[1], true), 0.03);
}

TEST(PhotoDepth, PhotosThatSeeNothingOfEachOtherGetNone) {
  BarePhotos bare(2);
  bare.views[1].camera.world_to_camera.rotation =
      Mat3d{{-1, 0, 0, 0, 1, 0, 0, 0, -1}} * bare.views[1].camera.world_to_camera.rotation;
  ThreadPool pool(1);
  for (const PhotoDepth& depth : photo_depth(bare.views, bare.points, {}, pool)) {
    EXPECT_TRUE(depth.depth.empty());
    EXPECT_EQ(depth.measured, 0);
  }
}

TEST(PhotoDepth, PlainWallsAndPhotosWithoutPointsGetNone) {
  BarePhotos plain(3), pointless(3);
  for (MatchView& view : plain.views) std::fill(view.luma.data.begin(), view.luma.data.end(), 0.6f);
  ThreadPool pool(1);
  for (const PhotoDepth& depth : photo_depth(plain.views, plain.points, {}, pool)) EXPECT_TRUE(depth.depth.empty());
  for (const PhotoDepth& depth : photo_depth(pointless.views, {}, {}, pool)) EXPECT_TRUE(depth.depth.empty());
}

TEST(PhotoDepth, APhotoWithoutPointsIsSearchedAsTheOthersAre) {
  BarePhotos bare(4);
  std::vector<Vec3f> few;  // seen by the first two photos alone, nearly: those of the last are dropped
  for (const Vec3f& p : bare.points) {
    const Vec3d in_last = bare.views[3].camera.world_to_camera * p.cast<double>();
    if (!(in_last.z > 0 && bare.views[3].camera.contains(bare.views[3].camera.project(in_last)))) few.push_back(p);
  }
  ASSERT_GT(few.size(), 20u);
  ThreadPool pool(2);
  EXPECT_GT(photo_depth(bare.views, few, {}, pool)[3].measured, 0.3);
}

TEST(PhotoDepth, DoesNotDependOnTheNumberOfThreads) {
  const BarePhotos bare(3);
  ThreadPool one(1), three(3);
  const auto a = photo_depth(bare.views, bare.points, {}, one), b = photo_depth(bare.views, bare.points, {}, three);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].depth.data, b[i].depth.data);
}

}  // namespace
}  // namespace aligngs
