#include "train/neighbour_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace aligngs {
namespace {

/// At `centre`, turned by `degrees` about the vertical axis.
Camera camera_at(const Vec3d& centre, double degrees) {
  Camera c;
  c.width = c.height = 10;
  c.fx = c.fy = 10;
  c.cx = c.cy = 5;
  const double half = degrees * 3.14159265358979 / 360;
  c.world_to_camera.rotation = rotation_matrix(Quaterniond{std::cos(half), 0, std::sin(half), 0});
  c.world_to_camera.translation = -(c.world_to_camera.rotation * centre);
  return c;
}

using Neighbours = std::vector<std::vector<int>>;

TEST(ChooseNeighbours, NearestCentreFirst) {
  const Neighbours n =
      choose_neighbours({camera_at({0, 0, 0}, 0), camera_at({0.4, 0, 0}, 5), camera_at({-0.2, 0, 0}, -5)}, 1);
  EXPECT_EQ(n, (Neighbours{{2, 1}, {0, 2}, {0, 1}}));
}

TEST(ChooseNeighbours, AxesMustAgreeWithinThirtyDegrees) {
  const Neighbours n =
      choose_neighbours({camera_at({0, 0, 0}, 0), camera_at({0.1, 0, 0}, 29), camera_at({0.1, 0, 0}, 31)}, 1);
  EXPECT_EQ(n[0], std::vector<int>{1});
}

TEST(ChooseNeighbours, DistancesAreSharesOfTheExtent) {
  const std::vector<Camera> cameras = {camera_at({0, 0, 0}, 0), camera_at({0.03, 0, 0}, 0), camera_at({5, 0, 0}, 0)};
  EXPECT_EQ(choose_neighbours(cameras, 4)[0], std::vector<int>{2});  // 0.0075 is too near, 1.25 is not too far
  EXPECT_EQ(choose_neighbours(cameras, 2)[0], std::vector<int>{1});  // 0.015 and 2.5
  EXPECT_EQ(choose_neighbours({}, 2), Neighbours());
}

TEST(ChooseNeighbours, KeepsTheFirstEight) {
  std::vector<Camera> cameras;
  for (int i = 0; i < 12; ++i) cameras.push_back(camera_at({0.05 * i, 0, 0}, 0));
  EXPECT_EQ(choose_neighbours(cameras, 1)[0], (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST(ChooseNeighbours, ACameraThatIsNotFiniteHasNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Neighbours n =
      choose_neighbours({camera_at({0, 0, 0}, 0), camera_at({nan, 0, 0}, 0), camera_at({0.2, 0, 0}, 0)}, 1);
  EXPECT_EQ(n, (Neighbours{{2}, {}, {0}}));
}

TEST(DrawNeighbour, IsAFunctionOfSeedAndIteration) {
  const std::vector<int> neighbours = {4, 7, 9};
  std::set<int> drawn;
  std::set<uint64_t> seeds;
  for (int64_t i = 1; i <= 60; ++i) {
    const DrawnNeighbour a = draw_neighbour(neighbours, 3, i), b = draw_neighbour(neighbours, 3, i);
    EXPECT_EQ(a.view, b.view);
    EXPECT_EQ(a.seed, b.seed);
    drawn.insert(a.view);
    seeds.insert(a.seed);
  }
  EXPECT_EQ(drawn, std::set<int>(neighbours.begin(), neighbours.end()));
  EXPECT_EQ(seeds.size(), 60u);
  EXPECT_EQ(draw_neighbour({}, 3, 1).view, -1);
}

}  // namespace
}  // namespace aligngs
