#include "refine/resection.h"

#include <gtest/gtest.h>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr double kRoughness = 0.6;  // no two places look alike
constexpr int kWanted = 3;          // of the photos' numbers, between the others
constexpr double kPlaced = 0.6;     // degrees: one and a half pixels of these small photos

class ResectionTest : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 6; ++i) {
      if (i != kWanted) views_.push_back(photo(true_camera(i), kRoughness));
    }
    for (size_t i = 0; i < views_.size(); ++i) photos_.push_back({static_cast<int>(i), &views_[i].match, nullptr});
    tracks_ = find_tracks(photos_, settings_.tracks.near_search, settings_.tracks, pool_);
  }

  /// The wanted photo with its camera turned by some degrees about the vertical.
  RefineView turned(double degrees) const {
    RefineView view = photo(true_camera(kWanted), kRoughness);
    const double c = std::cos(degrees * kRadiansPerDegree), s = std::sin(degrees * kRadiansPerDegree);
    Rigidd& pose = view.match.camera.world_to_camera;
    pose = Rigidd{Mat3d{{c, 0, s, 0, 1, 0, -s, 0, c}}, {}} * pose;
    return view;
  }

  /// Observations that placed it.
  int place(RefineView& view, const PhotoSearch& search) {
    std::vector<WantedPhoto> wanted{{kWanted + 100, &view.match, nullptr, 0}};
    place_photos({tracks_, photos_, 2}, wanted, search, settings_, pool_);
    return wanted[0].observations;
  }

  static double degrees_off(const RefineView& view) {
    return rotation_angle_between_degrees(view.match.camera.world_to_camera.rotation,
                                          true_camera(kWanted).world_to_camera.rotation);
  }

  std::vector<RefineView> views_;
  std::vector<TrackPhoto> photos_;
  std::vector<Track> tracks_;
  ResectionSettings settings_;
  ThreadPool pool_{2};
};

TEST_F(ResectionTest, APhotoNearItsPlaceIsPlaced) {
  RefineView view = turned(2);
  EXPECT_GT(place(view, {0.05, false}), 500);
  EXPECT_LT(degrees_off(view), kPlaced);
}

TEST_F(ResectionTest, APhotoFarFromItsPlaceIsPlacedByMost) {
  RefineView view = turned(8);
  EXPECT_GT(place(view, {0.15, true}), 500);
  EXPECT_LT(degrees_off(view), kPlaced);
}

TEST_F(ResectionTest, APhotoBeyondReachStaysWhereItWas) {
  RefineView view = turned(8);
  EXPECT_EQ(place(view, {0.05, false}), 0);
  EXPECT_NEAR(degrees_off(view), 8, 1e-9);
}

TEST_F(ResectionTest, APatternThatFitsElsewhereDoesNotPlaceAPhoto) {
  RefineView view = turned(6);
  EXPECT_EQ(place(view, {0.05, true}), 0);
  settings_.least_shown = 0;  // a few dozen places do agree with a wrong pose
  EXPECT_GT(place(view, {0.05, true}), 0);
  EXPECT_GT(degrees_off(view), 3);
}

TEST_F(ResectionTest, WithoutTracksNothingMoves) {
  tracks_.clear();
  RefineView view = turned(1);
  EXPECT_EQ(place(view, {0.05, true}), 0);
  EXPECT_NEAR(degrees_off(view), 1, 1e-9);
}

}  // namespace
}  // namespace aligngs
