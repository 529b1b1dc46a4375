#include "refine/tracks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

TrackSettings few_track_corners() {
  TrackSettings settings;
  settings.corners = {150, 5, 0.01};
  return settings;
}

/// Photos with their true cameras and depth, numbered from `first`.
std::vector<TrackPhoto> numbered(const std::vector<RefineView>& views, int first) {
  std::vector<TrackPhoto> out;
  for (const RefineView& view : views) out.push_back({first + static_cast<int>(out.size()), &view.match, &view.mask});
  return out;
}

class TracksTest : public testing::Test {
 protected:
  ThreadPool pool_{2};
};

TEST_F(TracksTest, BeginWithTheirCornerAndGoOnWhereOtherPhotosShowIt) {
  std::vector<RefineView> views;
  for (int i = 0; i < 4; ++i) views.push_back(photo(true_camera(i), 0.3));  // rough: no two places look alike
  const std::vector<Track> tracks = find_tracks(numbered(views, 0), 0.05, few_track_corners(), pool_);
  ASSERT_GT(tracks.size(), 30u);
  for (const Track& track : tracks) {
    ASSERT_GE(track.observations.size(), 2u);
    EXPECT_EQ(track.observations[0].view, track.view);
    EXPECT_EQ(track.observations[0].pixel.x, track.corner.x + 0.5);
    for (const Observation& o : track.observations) {
      EXPECT_LT(reprojection_error(views[static_cast<size_t>(o.view)].match.camera, track.point, o.pixel), 1);
    }
  }
}

TEST_F(TracksTest, AreNumberedAsTheirPhotosAre) {
  const std::vector<RefineView> views = photos(2, 0, 0, 0);
  const std::vector<Track> tracks = find_tracks(numbered(views, 7), 0.05, few_track_corners(), pool_);
  ASSERT_FALSE(tracks.empty());
  EXPECT_EQ(tracks.front().view, 7);
  EXPECT_EQ(tracks.front().observations[1].view, 8);
}

TEST_F(TracksTest, AMaskedPhotoBeginsNone) {
  std::vector<RefineView> views = photos(2, 0, 0, 0);
  views[0].mask = ImageF(kWidth, kHeight, 1);
  const std::vector<Track> tracks = find_tracks(numbered(views, 0), 0.05, few_track_corners(), pool_);
  ASSERT_FALSE(tracks.empty());
  for (const Track& track : tracks) EXPECT_EQ(track.view, 1);
}

TEST_F(TracksTest, ALonePhotoHasNone) {
  EXPECT_TRUE(find_tracks(numbered(photos(1, 0, 0, 0), 0), 0.05, few_track_corners(), pool_).empty());
}

TEST_F(TracksTest, TheirPointsAreFoundInPhotosThatBeginNone) {
  const std::vector<RefineView> views = photos(4, 0, 0, 0);
  const std::vector<TrackPhoto> all = numbered(views, 0);
  const std::vector<TrackPhoto> training(all.begin(), all.begin() + 3), wanted(all.begin() + 3, all.end());
  const std::vector<Track> tracks = find_tracks(training, 0.05, few_track_corners(), pool_);
  const std::vector<Observation> found = find_points(tracks, training, wanted, 0.05, few_track_corners(), pool_);
  ASSERT_GT(found.size(), 10u);
  for (const Observation& o : found) {
    EXPECT_EQ(o.view, 3);
    EXPECT_LT(reprojection_error(views[3].match.camera, tracks[static_cast<size_t>(o.point)].point, o.pixel), 0.5);
  }
}

TEST(CornersForSearch, ASmallPhotoGetsFewer) {
  EXPECT_EQ(corners_for_search({}, ImageF(160, 120, 1), 0.02).per_view, TrackSettings().corners.per_view / 4);
}

TEST(CornersForSearch, ALargePhotoGetsNoMoreButFartherApart) {
  const CornerSettings corners = corners_for_search({}, ImageF(640, 480, 1), 0.02);
  EXPECT_EQ(corners.per_view, TrackSettings().corners.per_view);
  EXPECT_EQ(corners.spacing, 2 * TrackSettings().corners.spacing);
}

TEST(CornersForSearch, AWideSearchMakesDoWithFewer) {
  EXPECT_EQ(corners_for_search({}, ImageF(320, 240, 1), 0.05).per_view, TrackSettings().wide_corners);
}

}  // namespace
}  // namespace aligngs
