#include "room/wall_pieces.h"

#include <gtest/gtest.h>

#include <limits>

namespace aligngs {
namespace {

constexpr double kTop = 2.5;

/// The plane y = 0, seen from y > 0; along it x falls.
ScenePlane wall_plane() {
  ScenePlane plane;
  plane.normal = {0, 1, 0};
  return plane;
}

/// Rays through x0..x1, z0..z1 of the plane that end `behind` it.
void add_rays(std::vector<SeenPoint>& points, double x0, double x1, double z0, double z1, double behind = 0) {
  for (double x = x0; x < x1; x += 0.04) {
    for (double z = z0; z < z1; z += 0.04) {
      const Vec3d from{x, 2, z}, to{x, -behind, z};
      points.push_back({from, to, {0, 1, 0}, 2 + behind});
    }
  }
}

std::vector<WallPiece> pieces_of(const std::vector<SeenPoint>& points) {
  return wall_pieces(wall_plane(), points, 0, kTop);
}

TEST(WallPieces, AWallIsOnePieceOfItsLength) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 3, 0, kTop);
  const std::vector<WallPiece> pieces = pieces_of(points);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].last - pieces[0].first, 3, 0.15);
  EXPECT_NEAR(pieces[0].last, 0, 0.11) << "x falls along the plane";
}

TEST(WallPieces, ACupboardWithAWallAboveItIsNone) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 3, 0, 1.9);
  add_rays(points, 0, 3, 1.9, kTop, 0.5);
  EXPECT_TRUE(pieces_of(points).empty());
}

TEST(WallPieces, ACupboardAboveWhichNobodyLooksIsOne) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 3, 0, 1.9);
  EXPECT_EQ(pieces_of(points).size(), 1u);
}

TEST(WallPieces, CupboardsWithAWallBelowThemAreNone) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 3, 1.4, kTop);
  add_rays(points, 0, 3, 0.9, 1.4, 0.35);
  EXPECT_TRUE(pieces_of(points).empty());
}

TEST(WallPieces, ADoorwayAndAWindowAreInAWall) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 0.5, 0, kTop);
  add_rays(points, 0.5, 1.4, 0, 2, 3);
  add_rays(points, 0.5, 1.4, 2, kTop);
  add_rays(points, 1.4, 2, 0, kTop);
  add_rays(points, 2, 3.5, 0, 0.9);
  add_rays(points, 2, 3.5, 0.9, 2.1, 8);
  add_rays(points, 2, 3.5, 2.1, kTop);
  add_rays(points, 3.5, 4, 0, kTop);
  const std::vector<WallPiece> pieces = pieces_of(points);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].last - pieces[0].first, 4, 0.15);
}

TEST(WallPieces, ACupboardInLineWithAWallIsJudgedByItself) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 2, 0, kTop);
  add_rays(points, 2, 4, 0, kTop, 2);
  add_rays(points, 4, 5, 0, 2);
  add_rays(points, 4, 5, 2, kTop, 0.5);
  const std::vector<WallPiece> pieces = pieces_of(points);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].last - pieces[0].first, 2, 0.15);
}

TEST(WallPieces, ThingsAreSeenThroughAWindowAndADoorwayAlone) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 1, 0, kTop);
  add_rays(points, 1, 2, 2, kTop);
  add_rays(points, 2, 3, 0, 1);
  add_rays(points, 2, 3, 2, kTop);
  const std::vector<WallPiece> pieces = pieces_of(points);
  const auto through = [&](double x, double z, double behind) {
    return is_seen_through(pieces, wall_plane(), {{x, 2, z}, {x, -behind, z}, {0, 1, 0}, 2}, 0, kTop, {});
  };
  EXPECT_TRUE(through(2.5, 1.5, 0.5)) << "a window";
  EXPECT_TRUE(through(1.5, 1, 2)) << "a doorway";
  EXPECT_FALSE(through(1.5, 1, 0.5)) << "below a cupboard";
  EXPECT_FALSE(through(2.5, 1.5, 0.02)) << "on the wall";
  EXPECT_FALSE(through(5, 1.5, 0.5)) << "beside the wall";
}

TEST(WallPieces, WhatIsLowOrNarrowIsNone) {
  std::vector<SeenPoint> low, narrow;
  add_rays(low, 0, 3, 0, 0.8);
  add_rays(narrow, 0, 0.25, 0, kTop);
  EXPECT_TRUE(pieces_of(low).empty());
  EXPECT_TRUE(pieces_of(narrow).empty());
}

TEST(WallPieces, PointsThatFaceElsewhereAreNotOnIt) {
  std::vector<SeenPoint> points;
  add_rays(points, 0, 3, 0, kTop);
  for (SeenPoint& point : points) point.normal = {0, 0, 1};
  EXPECT_TRUE(pieces_of(points).empty());
}

TEST(WallPieces, PlacesThatAreNotFiniteAndNothingAreNone) {
  std::vector<SeenPoint> points;
  EXPECT_TRUE(pieces_of(points).empty());
  points.push_back({{0, 2, 1}, {std::numeric_limits<double>::quiet_NaN(), 0, 1}, {0, 1, 0}, 2});
  points.push_back({{0, 2, 1}, {std::numeric_limits<double>::infinity(), 0, 1}, {0, 1, 0}, 2});
  EXPECT_TRUE(pieces_of(points).empty());
}

}  // namespace
}  // namespace aligngs
