#include "room/largest_cluster.h"

#include <gtest/gtest.h>

#include <limits>

namespace aligngs {
namespace {

std::vector<Vec3d> row(double from, int count, double step) {
  std::vector<Vec3d> out;
  for (int i = 0; i < count; ++i) out.push_back({from + i * step, 0, 0});
  return out;
}

TEST(LargestCluster, OfNothingIsNothing) {
  EXPECT_TRUE(largest_cluster({}, 0.1).empty());
  EXPECT_TRUE(largest_cluster(row(0, 5, 0.01), 0).empty());
}

TEST(LargestCluster, StraysFarAwayGo) {
  std::vector<Vec3d> points = row(0, 100, 0.05);
  const std::vector<Vec3d> strays = row(20, 30, 0.05);
  points.insert(points.end(), strays.begin(), strays.end());
  EXPECT_EQ(largest_cluster(points, 0.08).size(), 100u);
}

TEST(LargestCluster, PiecesNearEachOtherStay) {
  std::vector<Vec3d> points = row(0, 50, 0.01);
  const std::vector<Vec3d> near = row(0.55, 20, 0.01);
  points.insert(points.end(), near.begin(), near.end());
  EXPECT_EQ(largest_cluster(points, 0.08).size(), 70u);
}

TEST(LargestCluster, PointsThatAreNotFiniteAreLeftOut) {
  std::vector<Vec3d> points = row(0, 3, 0.01);
  points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  points.push_back({std::numeric_limits<double>::infinity(), 0, 0});
  EXPECT_EQ(largest_cluster(points, 0.08).size(), 3u);
}

}  // namespace
}  // namespace aligngs
