#include "refine/screen_support.h"

#include <gtest/gtest.h>

#include "refine/testing/screen_room.h"

namespace aligngs {
namespace {

using namespace screen_room;

Panel panel_of(double z, double low) {
  Panel panel;
  panel.normal = {0, 0, -1};
  panel.offset = z;
  set_upright(panel, planes());
  panel.low[0] = -kHalfWidth;
  panel.high[0] = kHalfWidth;
  panel.low[1] = -low;  // up is -y
  panel.high[1] = -kHigh;
  panel.depth = z;
  return panel;
}

struct Room {
  Photos photos{Screen{}};
  std::vector<ScenePlane> layout = planes();
  ThreadPool pool{2};
  ScreenSupport support() { return ScreenSupport(photos.views, kScreenClasses, layout, {}, pool); }
};

TEST(ScreenSupport, AScreenJustBeforeItsWallHangs) {
  Room room;
  EXPECT_TRUE(room.support().hangs(panel_of(kHanging, kLowHanging)));
  EXPECT_FALSE(room.support().hangs(panel_of(kHanging - 0.37, kLowHanging)));
}

TEST(ScreenSupport, AScreenOnTheSideboardStands) {
  Room room;
  EXPECT_TRUE(room.support().stands(panel_of(kStanding, kLowStanding)));
}

TEST(ScreenSupport, OneBeforeOrHighAboveItDoesNot) {
  Room room;
  EXPECT_FALSE(room.support().stands(panel_of(kFront - 0.25, kLowStanding)));
  EXPECT_FALSE(room.support().stands(panel_of(kStanding, kTop - 0.3)));
}

TEST(ScreenSupport, AWallThatIsNotParallelCarriesNothing) {
  Room room;
  room.layout[0] = plane({-1, 0, 0}, 1, PlaneKind::kWall);
  EXPECT_FALSE(room.support().hangs(panel_of(kHanging, kLowHanging)));
}

TEST(ScreenSupport, WithoutFloorOrCeilingNothingIsLevel) {
  Room room;
  room.layout.pop_back();
  EXPECT_FALSE(room.support().stands(panel_of(kStanding, kLowStanding)));
  room.layout.push_back(plane({0, 1, 0}, 1.5, PlaneKind::kCeiling));
  EXPECT_TRUE(room.support().stands(panel_of(kStanding, kLowStanding)));
}

}  // namespace
}  // namespace aligngs
