#include "refine/pair_consensus.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "core/rotation_vector.h"
#include "refine/testing/small_camera.h"

namespace aligngs {
namespace {

constexpr double kFarOff = 30;  // pixels, of wrong matches: beyond what pairs agree within, inside of a wide search

/// Two photos. The second is some degrees and centimetres from where its camera is.
class PairConsensus : public testing::Test {
 protected:
  PairConsensus() {
    views_[0].camera = views_[1].camera = small_camera();
    true_second_ = small_camera();
    true_second_.world_to_camera = Rigidd{rotation_of({0.03, -0.05, 0.02}), {-0.4, 0.1, 0.05}};
    views_[1].camera.world_to_camera =
        Rigidd{rotation_of({0.02, 0.01, -0.03}), {0.05, -0.03, 0.04}} * true_second_.world_to_camera;
    photos_ = {{4, &views_[0], nullptr}, {7, &views_[1], nullptr}};
  }

  /// A track of the first photo that the second shows within a pixel, or far from there.
  void add_track(bool right) {
    const double depth = random_.uniform(1.5, 4);
    Track track;
    track.view = 4;
    Observation own, other;
    own.view = 4;
    own.pixel = {random_.uniform(60, 260), random_.uniform(60, 180)};
    track.point = small_camera().unproject(own.pixel.x, own.pixel.y, depth);
    other.view = 7;
    const Vec2d at = true_second_.project(true_second_.world_to_camera * track.point);
    const double off = right ? 0.5 : kFarOff;
    other.pixel = {at.x + random_.uniform(-off, off), at.y + random_.uniform(-off, off)};
    track.observations = {own, other};
    right_.push_back(right);
    track.corner.x = static_cast<int>(right_.size()) - 1;  // its number here
    tracks_.push_back(track);
  }

  void add_tracks(int count, bool right) {
    for (int i = 0; i < count; ++i) add_track(right);
  }

  int kept(bool right) const {
    int count = 0;
    for (const Track& t : tracks_) count += right_[static_cast<size_t>(t.corner.x)] == right;
    return count;
  }

  MatchView views_[2];
  Camera true_second_;
  std::vector<TrackPhoto> photos_;
  std::vector<Track> tracks_;
  std::vector<bool> right_;
  Random random_{5};
  ThreadPool pool_{2};
};

TEST_F(PairConsensus, LeavesThePairItsRightMatches) {
  add_tracks(40, true);
  add_tracks(60, false);
  keep_agreeing_matches(tracks_, photos_, {}, pool_);
  EXPECT_EQ(kept(true), 40);
  EXPECT_LT(kept(false), 6);  // a few are right by chance
}

TEST_F(PairConsensus, LeavesAPairWithFewMatchesAsItIs) {
  add_tracks(5, true);
  add_tracks(10, false);
  keep_agreeing_matches(tracks_, photos_, {}, pool_);
  EXPECT_EQ(tracks_.size(), 15u);
}

TEST_F(PairConsensus, LeavesNothingToAPairWhoseMatchesAgreeByChance) {
  add_tracks(60, false);
  keep_agreeing_matches(tracks_, photos_, {}, pool_);
  EXPECT_TRUE(tracks_.empty());
}

TEST_F(PairConsensus, JudgesEachPairByItself) {
  add_tracks(40, true);
  MatchView third = views_[0];
  photos_.push_back({9, &third, nullptr});
  for (Track& track : tracks_) {  // no pose has all of these
    Observation wrong;
    wrong.view = 9;
    wrong.pixel = {random_.uniform(0, 320), random_.uniform(0, 240)};
    track.observations.push_back(wrong);
  }
  keep_agreeing_matches(tracks_, photos_, {}, pool_);
  ASSERT_EQ(kept(true), 40);
  for (const Track& track : tracks_) {
    ASSERT_EQ(track.observations.size(), 2u);
    EXPECT_EQ(track.observations[1].view, 7);
  }
}

TEST_F(PairConsensus, IsTheSameForAnyNumberOfThreads) {
  add_tracks(40, true);
  add_tracks(60, false);
  std::vector<Track> again = tracks_;
  keep_agreeing_matches(tracks_, photos_, {}, pool_);
  ThreadPool one(1);
  keep_agreeing_matches(again, photos_, {}, one);
  ASSERT_EQ(again.size(), tracks_.size());
  for (size_t i = 0; i < again.size(); ++i) EXPECT_EQ(again[i].corner.x, tracks_[i].corner.x);
}

TEST_F(PairConsensus, NoTracksStayNone) {
  keep_agreeing_matches(tracks_, photos_, {}, pool_);
  EXPECT_TRUE(tracks_.empty());
}

}  // namespace
}  // namespace aligngs
