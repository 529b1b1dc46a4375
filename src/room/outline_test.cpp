#include "room/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/angles.h"

namespace aligngs {
namespace {

/// Class 0 is wall, class 1 anything else.
std::vector<RoomClass> classes() {
  RoomClass wall;
  wall.wall = true;
  return {wall, {}};
}

double area_of(const std::vector<OutlineSide>& sides) {
  std::vector<Vec2d> corners;
  for (const OutlineSide& side : sides) corners.push_back(side.from);
  return signed_area(corners);
}

/// The view all around from cameras at `centres` on walls along `corners` (counter-clockwise); from side `hidden` on
/// they see something else.
std::vector<SeenRay> look(const std::vector<Vec2d>& corners, const std::vector<Vec2d>& centres, size_t hidden = 1000) {
  std::vector<SeenRay> rays;
  for (const Vec2d& c : centres) {
    for (int k = 0; k < 2000; ++k) {
      const double angle = 2 * kPi * k / 2000;
      const Vec2d d{std::cos(angle), std::sin(angle)};
      double nearest = 1e9;
      size_t side = 0;
      for (size_t i = 0; i < corners.size(); ++i) {
        const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()], e{b.x - a.x, b.y - a.y};
        const double det = d.x * e.y - d.y * e.x;
        if (std::abs(det) < 1e-12) continue;
        const double t = ((a.x - c.x) * e.y - (a.y - c.y) * e.x) / det,
                     u = ((a.x - c.x) * d.y - (a.y - c.y) * d.x) / det;
        if (t > 1e-9 && u >= 0 && u <= 1 && t < nearest) nearest = t, side = i;
      }
      rays.push_back({{c.x, c.y, 1.4},
                      {c.x + d.x * nearest, c.y + d.y * nearest, 1.2},
                      static_cast<uint16_t>(side < hidden ? 0 : 1)});
    }
  }
  return rays;
}

std::vector<PlanLine> lines_of(const std::vector<Vec2d>& corners) {
  std::vector<PlanLine> lines;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const Vec2d normal{-(b.y - a.y) / length, (b.x - a.x) / length};
    lines.push_back({normal, -(normal.x * a.x + normal.y * a.y)});
  }
  return lines;
}

const std::vector<Vec2d> kBox = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
const std::vector<Vec2d> kL = {{0, 0}, {5, 0}, {5, 2}, {3, 2}, {3, 4}, {0, 4}};
const std::vector<Vec2d> kBay = {{0, 0}, {4, 0}, {4, 3}, {3, 3}, {2.5, 3.7}, {1.5, 3.7}, {1, 3}, {0, 3}};

TEST(RoomOutline, WithoutRaysThereIsNone) { EXPECT_TRUE(find_outline(lines_of(kBox), {}, classes()).empty()); }

TEST(RoomOutline, FourWallsMakeARectangle) {
  const auto sides = find_outline(lines_of(kBox), look(kBox, {{1, 1}, {3, 2}}), classes());
  ASSERT_EQ(sides.size(), 4u);
  EXPECT_NEAR(area_of(sides), 12, 1e-6);
  for (const OutlineSide& side : sides) EXPECT_FALSE(side.line.assumed);
}

TEST(RoomOutline, AnLKeepsItsInnerCorner) {
  const auto sides = find_outline(lines_of(kL), look(kL, {{1, 1}, {4, 1}, {1, 3}}), classes());
  EXPECT_EQ(sides.size(), 6u);
  EXPECT_NEAR(area_of(sides), 16, 1e-6);
}

TEST(RoomOutline, ABayKeepsItsSlantedWalls) {
  const auto sides = find_outline(lines_of(kBay), look(kBay, {{1, 1}, {3, 1}, {2, 2.5}}), classes());
  EXPECT_EQ(sides.size(), 8u);
  EXPECT_NEAR(area_of(sides), 12 + 0.7 * 1.5, 1e-6);
}

TEST(RoomOutline, SidesWithoutWallAreAssumed) {
  const auto sides = find_outline({lines_of(kBox)[0]}, look(kBox, {{1, 1}, {3, 2}}, 1), classes());
  ASSERT_EQ(sides.size(), 4u);
  EXPECT_NEAR(area_of(sides), 12, 0.3);
  int assumed = 0;
  for (const OutlineSide& side : sides) assumed += side.line.assumed;
  EXPECT_EQ(assumed, 3);
}

TEST(RoomOutline, WithoutWallsTheBoxOfTheSurfacesIsAssumed) {
  const auto sides = find_outline({}, look(kBox, {{1, 1}, {3, 2}}, 0), classes());
  ASSERT_EQ(sides.size(), 4u);
  EXPECT_NEAR(area_of(sides), 12, 0.3);
}

TEST(RoomOutline, AWallSeenTwiceIsOneSide) {
  std::vector<PlanLine> lines = lines_of(kBox);
  lines.push_back({{0, 1}, -0.03});  // 3 cm before the wall at y = 0
  EXPECT_EQ(find_outline(lines, look(kBox, {{1, 1}, {3, 2}}), classes()).size(), 4u);
}

}  // namespace
}  // namespace aligngs
