#include "room/openings.h"

#include <gtest/gtest.h>

#include <limits>

#include "scene/label_set.h"

namespace aligngs {
namespace {

constexpr uint16_t kWallClass = 0, kPaneClass = 8, kDoorClass = 14, kPaintingClass = 22,
                   kMirrorClass = 27;  // ADE20K

/// One wall 4 m long and 2.5 m high along y = 0, seen from 2 m before it. `label_at` gives the label of each place,
/// `behind` its distance behind the wall.
template <class Label, class Behind>
WallVotes votes_of(Label&& label_at, Behind&& behind) {
  const MeasuredWall wall{{0, 0}, {4, 0}, {0, 1, 0}, 2.5, 0, 0, false};
  std::vector<SeenRay> rays;
  const Vec3d from{2, 2, 1.3};
  for (double x = 0.005; x < 4; x += 0.01) {
    for (double z = 0.005; z < 2.5; z += 0.01) {
      const Vec3d on{x, 0, z};
      rays.push_back({from, on + (on - from) * (behind(x, z) / 2), label_at(x, z)});
    }
  }
  return wall_votes({wall}, rays, room_classes(ade20k_labels()))[0];
}

const auto kOnWall = [](double, double) { return 0.0; };

TEST(Openings, ABareWallHasNoneAndIsSeen) {
  const WallVotes votes = votes_of([](double, double) { return kWallClass; }, kOnWall);
  EXPECT_TRUE(find_openings(votes, 0, ade20k_labels()).empty());
  EXPECT_NEAR(seen_share(votes), 1, 0.02);
}

TEST(Openings, AWallThatNobodySeesHasNone) {
  const MeasuredWall wall{{0, 0}, {4, 0}, {0, 1, 0}, 2.5, 0, 0, false};
  const WallVotes votes = wall_votes({wall}, {}, room_classes(ade20k_labels()))[0];
  EXPECT_TRUE(find_openings(votes, 0, ade20k_labels()).empty());
  EXPECT_EQ(seen_share(votes), 0);
}

TEST(Openings, AWindowIsItsHoleWhateverThePanesDepth) {
  const auto in = [](double x, double z) { return x > 1 && x < 2.2 && z > 0.9 && z < 2.1; };
  const WallVotes votes = votes_of([&](double x, double z) { return in(x, z) ? kPaneClass : kWallClass; },
                                   [&](double x, double z) { return in(x, z) ? 3.0 : 0.0; });
  const std::vector<MeasuredOpening> found = find_openings(votes, 5, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, OpeningKind::kWindow);
  EXPECT_EQ(found[0].wall, 5);
  EXPECT_NEAR(found[0].left, 1, 0.03);
  EXPECT_NEAR(found[0].right, 2.2, 0.03);
  EXPECT_NEAR(found[0].bottom, 0.9, 0.03);
  EXPECT_NEAR(found[0].top, 2.1, 0.03);
}

TEST(Openings, TheNicheOfAWindowBelongsToIt) {
  const auto hole = [](double x, double z) { return x > 1 && x < 2 && z > 1 && z < 2; };
  const auto pane = [](double x, double z) { return x > 1.1 && x < 2 && z > 1.1 && z < 2; };
  const WallVotes votes = votes_of([&](double x, double z) { return pane(x, z) ? kPaneClass : kWallClass; },
                                   [&](double x, double z) { return hole(x, z) ? 0.1 : 0.0; });
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].left, 1, 0.03);
  EXPECT_NEAR(found[0].bottom, 1, 0.03);
}

// A teacher that takes the view of a window for a painting is corrected by where the pane lies.
TEST(Openings, APaintingInANicheIsAWindow) {
  const auto in = [](double x, double z) { return x > 1 && x < 2.4 && z > 0.9 && z < 2.1; };
  const WallVotes votes = votes_of([&](double x, double z) { return in(x, z) ? kPaintingClass : kWallClass; },
                                   [&](double x, double z) { return in(x, z) ? 0.1 : 0.0; });
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, OpeningKind::kWindow);
  EXPECT_EQ(found[0].class_name, "windowpane");
  EXPECT_NEAR(found[0].right, 2.4, 0.03);
}

TEST(Openings, APaintingOnAWallThatIsTwoCentimetresOffStaysOne) {
  const auto in = [](double x, double z) { return x > 1 && x < 2.4 && z > 0.9 && z < 2.1; };
  const WallVotes votes = votes_of([&](double x, double z) { return in(x, z) ? kPaintingClass : kWallClass; },
                                   [](double, double) { return 0.02; });
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, OpeningKind::kPicture);
}

TEST(Openings, AMirrorInANicheIsAWindow) {
  const auto in = [](double x, double z) { return x > 1 && x < 2.4 && z > 0.9 && z < 2.1; };
  const WallVotes votes = votes_of([&](double x, double z) { return in(x, z) ? kMirrorClass : kWallClass; },
                                   [&](double x, double z) { return in(x, z) ? 0.15 : 0.0; });
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, OpeningKind::kWindow);
}

TEST(Openings, AMirrorThatShowsTheRoomBehindItStaysOne) {
  const auto in = [](double x, double z) { return x > 1 && x < 2.4 && z > 0.9 && z < 2.1; };
  const WallVotes votes = votes_of([&](double x, double z) { return in(x, z) ? kMirrorClass : kWallClass; },
                                   [&](double x, double z) { return in(x, z) ? 2.0 : 0.0; });
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, OpeningKind::kMirror);
}

TEST(Openings, ADoorReachesTheFloor) {
  const WallVotes votes = votes_of(
      [](double x, double z) { return x > 1 && x < 1.9 && z > 0.08 && z < 2 ? kDoorClass : kWallClass; }, kOnWall);
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].bottom, 0);
  EXPECT_NEAR(found[0].top, 2, 0.03);
}

TEST(Openings, ASillThatIsWiderDoesNotWidenTheWindow) {
  const auto sill = [](double x, double z) { return x > 0.8 && x < 2.4 && z > 0.96 && z < 1; };
  const auto pane = [](double x, double z) { return x > 1 && x < 2.2 && z > 1 && z < 2; };
  const WallVotes votes =
      votes_of([&](double x, double z) { return pane(x, z) || sill(x, z) ? kPaneClass : kWallClass; }, kOnWall);
  const std::vector<MeasuredOpening> found = find_openings(votes, 0, ade20k_labels());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].left, 1, 0.03);
  EXPECT_NEAR(found[0].right, 2.2, 0.03);
}

TEST(Openings, WhatStandsBeforeTheWallIsNotOnIt) {
  const WallVotes votes = votes_of([](double, double) { return kPaintingClass; }, [](double, double) { return -0.6; });
  EXPECT_TRUE(find_openings(votes, 0, ade20k_labels()).empty());
}

TEST(Openings, SpecksAreNone) {
  const WallVotes votes = votes_of(
      [](double x, double z) { return x > 1 && x < 1.08 && z > 1 && z < 1.08 ? kPaintingClass : kWallClass; }, kOnWall);
  EXPECT_TRUE(find_openings(votes, 0, ade20k_labels()).empty());
}

TEST(WallVotes, RaysThatAreNotFiniteVoteNothing) {
  const MeasuredWall wall{{0, 0}, {4, 0}, {0, 1, 0}, 2.5, 0, 0, false};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const WallVotes votes =
      wall_votes({wall}, {{{2, 2, 1}, {nan, nan, nan}, kWallClass}}, room_classes(ade20k_labels()))[0];
  EXPECT_EQ(seen_share(votes), 0);
}

}  // namespace
}  // namespace aligngs
