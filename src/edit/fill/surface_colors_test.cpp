#include "edit/fill/surface_colors.h"

#include <gmock/gmock.h>

#include <functional>

#include "edit/fill/testing/square_grid.h"

namespace aligngs {
namespace {

/// 40 x 40 cells of 1 cm.
PlaneGrid grid() { return square_grid(40, 0.01); }

/// Known everywhere but in the square from 12 to 28.
std::vector<KnownColor> frame(const std::function<float(double, double)>& shade) {
  std::vector<KnownColor> known;
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) {
      if (i >= 12 && i < 28 && j >= 12 && j < 28) continue;
      const float s = shade(i + 0.5, j + 0.5);
      known.push_back({{i + 0.5, j + 0.5}, {s, s, s}, 1});
    }
  }
  return known;
}

TEST(ContinuedColors, AnEvenColourStays) {
  for (const Vec3f& c : continued_colors(grid(), frame([](double, double) { return 0.4f; })))
    EXPECT_NEAR(c.x, 0.4f, 1e-5);
}

TEST(ContinuedColors, AGradientOfLightGoesOn) {
  const auto colors = continued_colors(grid(), frame([](double x, double) { return static_cast<float>(0.01 * x); }));
  for (int i = 12; i < 28; ++i) EXPECT_NEAR(colors[grid().index(i, 20)].x, 0.01 * (i + 0.5), 0.02) << i;
}

TEST(ContinuedColors, OneStrangeColourDrawsNoStreak) {
  const auto colors = continued_colors(
      grid(), frame([](double x, double y) { return x > 19 && x < 20 && y > 11 && y < 12 ? 1.f : 0.4f; }));
  EXPECT_NEAR(colors[grid().index(19, 16)].x, 0.4f, 0.08) << "four cells from it, little is left";
  EXPECT_NEAR(colors[grid().index(19, 24)].x, 0.4f, 0.02);
}

TEST(ContinuedColors, NothingKnownIsNothing) { EXPECT_TRUE(continued_colors(grid(), {}).empty()); }

TEST(ContinuedColors, PlacesOutsideOfTheGridDoNotCount) {
  EXPECT_TRUE(continued_colors(grid(), {{{-3, 5}, {1, 1, 1}, 1}, {{41, 5}, {1, 1, 1}, 1}}).empty());
}

}  // namespace
}  // namespace aligngs
