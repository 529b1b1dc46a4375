#include "edit/fill/plane_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

/// A grid of 2 x 1, turned by 30 degrees about (3, 4).
std::vector<Vec2d> turned_grid() {
  const double c = std::cos(0.5235987755982988), s = std::sin(0.5235987755982988);  // 30 degrees
  std::vector<Vec2d> places;
  for (double x = -1; x <= 1; x += 0.05) {
    for (double y = -0.5; y <= 0.5; y += 0.05) places.push_back({3 + c * x - s * y, 4 + s * x + c * y});
  }
  return places;
}

TEST(PlaneRectangle, FollowsTheTurnOfTheThing) {
  const PlaneRectangle r = rectangle_of(turned_grid());
  const double a = r.high[0] - r.low[0], b = r.high[1] - r.low[1];
  EXPECT_NEAR(std::max(a, b), 2, 0.15);
  EXPECT_NEAR(std::min(a, b), 1, 0.15);
  EXPECT_TRUE(r.holds({3, 4}, 0));
  EXPECT_FALSE(r.holds({3, 4.9}, 0)) << "inside of the box along the axes, and outside of the thing";
}

TEST(PlaneRectangle, StraysDoNotWidenIt) {
  std::vector<Vec2d> places = turned_grid();
  places.push_back({30, 40});
  const PlaneRectangle r = rectangle_of(places);
  EXPECT_LT(std::max(r.high[0] - r.low[0], r.high[1] - r.low[1]), 2.2);
}

}  // namespace
}  // namespace aligngs
