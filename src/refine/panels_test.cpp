#include "refine/panels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"

namespace aligngs {
namespace {

// x right, y down, z forward, metres: a wall at z = 3, a floor at y = 1.2, cameras about the origin.
ScenePlane plane(const Vec3d& normal, double offset, PlaneKind kind) {
  ScenePlane p;
  p.normal = normal;
  p.offset = offset;
  p.kind = kind;
  return p;
}
const std::vector<ScenePlane> kRoom = {plane({0, 0, -1}, 3, PlaneKind::kWall),
                                       plane({0, -1, 0}, 1.2, PlaneKind::kFloor)};

/// Points of the frame of a rectangle that `views` photos measured, each as a region of its own.
struct Frames {
  std::vector<PanelPoint> points;
  Random random{7};
  uint32_t parts = 0;

  void add(const Vec3d& corner, const Vec3d& across, const Vec3d& down, int views, double noise = 0.003) {
    const Vec3d normal = normalized(cross(across, down));
    for (int view = 0; view < views; ++view, ++parts) {
      for (int i = 0; i < 200; ++i) {
        const double along = random.uniform();
        const Vec3d at[] = {corner + across * along, corner + across * along + down, corner + down * along,
                            corner + across + down * along};
        add_point(at[i % 4] + normal * (noise * random.normal()), view);
      }
    }
  }
  void add_point(const Vec3d& position, int view) {
    points.push_back({position, {0.1 * view, 0, 0}, 3, 0.5, view, parts});
  }
};

TEST(Panels, AFrameGivesThePlaneAndRectangleOfItsPane) {
  Frames frames;
  frames.add({-0.5, -0.6, 3.1}, {1.2, 0, 0}, {0, 1, 0}, 3);
  const std::vector<Panel> panels = find_panels(frames.points, kRoom, {}, 1);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].normal.z, -1, 1e-6);
  EXPECT_NEAR(panels[0].offset, 3.1, 0.003);
  EXPECT_EQ(panels[0].views, 3);
  EXPECT_TRUE(panels[0].contains({0.1, -0.1, 3.1}));
  EXPECT_FALSE(panels[0].contains({0.9, -0.1, 3.1}));
  EXPECT_FALSE(panels[0].contains({0.1, 0.6, 3.1}));
}

TEST(Panels, ANearlyParallelOneIsMadeParallelToItsWall) {
  Frames frames;
  frames.add({-0.5, -0.6, 3.05}, {1.2, 0, 0.1}, {0, 1, 0}, 3);  // five degrees
  const std::vector<Panel> panels = find_panels(frames.points, kRoom, {}, 1);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(std::abs(panels[0].normal.z), 1, 1e-9);
}

TEST(Panels, AScreenStandsAsItIsTurned) {
  Frames frames;
  const double c = std::cos(0.6), s = std::sin(0.6);
  frames.add({-0.3, 0, 2}, {0.8 * c, 0, 0.8 * s}, {0, 0.5, 0}, 3);
  const std::vector<Panel> panels = find_panels(frames.points, kRoom, {}, 1);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].normal.x, s, 0.02);
  EXPECT_NEAR(panels[0].normal.z, -c, 0.02);
  EXPECT_NEAR(std::abs(panels[0].up.y), 1, 0.02);
}

TEST(Panels, AWindowAndTheCurtainsBeforeItAreTwo) {
  Frames frames;
  frames.add({-0.5, -0.6, 3.1}, {1.2, 0, 0}, {0, 1, 0}, 3);
  frames.parts = 0;  // teachers call both a window
  frames.add({-0.9, -0.8, 2.9}, {2, 0, 0}, {0, 1.6, 0}, 3);
  const std::vector<Panel> panels = find_panels(frames.points, kRoom, {}, 1);
  ASSERT_EQ(panels.size(), 2u);
  EXPECT_NEAR(panels[0].offset + panels[1].offset, 6.0, 0.01);
}

TEST(Panels, WhatIsLevelIsATableTop) {
  Frames frames;
  frames.add({-0.5, 0.5, 2}, {1, 0, 0}, {0, 0, 0.6}, 3);
  EXPECT_TRUE(find_panels(frames.points, kRoom, {}, 1).empty());
}

TEST(Panels, ALineAndWhatOnePhotoSawAreNone) {
  Frames edge;
  edge.add({-0.5, -0.6, 3.1}, {1.2, 0, 0}, {0, 0.02, 0}, 3);
  EXPECT_TRUE(find_panels(edge.points, kRoom, {}, 1).empty());
  Frames once;
  once.add({-0.5, -0.6, 3.1}, {1.2, 0, 0}, {0, 1, 0}, 1);
  EXPECT_TRUE(find_panels(once.points, kRoom, {}, 1).empty());
}

TEST(Panels, WhatIsNotFlatIsNone) {
  Frames frames;
  for (int view = 0; view < 3; ++view, ++frames.parts) {
    for (int i = 0; i < 300; ++i) {
      frames.add_point(
          {frames.random.uniform(-0.5, 0.5), frames.random.uniform(-0.5, 0.5), frames.random.uniform(2, 3)}, view);
    }
  }
  EXPECT_TRUE(find_panels(frames.points, kRoom, {}, 1).empty());
}

TEST(Panels, PointsThatAreNoNumbersAreIgnored) {
  Frames frames;
  frames.add({-0.5, -0.6, 3.1}, {1.2, 0, 0}, {0, 1, 0}, 3);
  const size_t exact = find_panels(frames.points, kRoom, {}, 1).size();
  frames.add_point({std::numeric_limits<double>::quiet_NaN(), 0, 3}, 0);
  frames.add_point({0, std::numeric_limits<double>::infinity(), 3}, 0);
  EXPECT_EQ(find_panels(frames.points, kRoom, {}, 1).size(), exact);
  EXPECT_TRUE(find_panels(std::vector<PanelPoint>{}, kRoom, {}, 1).empty());
}

TEST(Panels, TheRoomMayBeUnknown) {
  Frames frames;
  frames.add({-0.5, -0.6, 3.1}, {1.2, 0, 0}, {0, 1, 0}, 3);
  const std::vector<Panel> panels = find_panels(frames.points, {}, {}, 1);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].normal.z, -1, 0.01);
  EXPECT_NEAR(dot(panels[0].up, panels[0].across), 0, 1e-9);
}

}  // namespace
}  // namespace aligngs
