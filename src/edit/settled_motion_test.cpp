#include "edit/settled_motion.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/edit_text.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

/// The small room, looked at along +z: +x is to the right.
class SettledMotion : public testing::Test {
 protected:
  SettledMotion() : room_(small_room::make(pool_)) {
    Camera camera;
    camera.world_to_camera.translation = {0, 1, 4};
    room_.cameras = {camera};
  }
  Vec3d settled(const char* text, std::optional<double> metres = 1) {
    EditOperation edit = parse_edit(text);
    settle_motion(room_, metres, edit);
    EXPECT_TRUE(edit.motion.toward.empty());
    return edit.motion.shift;
  }
  ThreadPool pool_{2};
  EditableRoom room_;
};

TEST_F(SettledMotion, MetresAreSceneUnitsOfAKnownLength) {
  EXPECT_DOUBLE_EQ(settled("move box 0.5 m to the right", 0.25).x, 2);
  EXPECT_DOUBLE_EQ(settled("move box 0.5 to the right", 0.25).x, 0.5);
}

TEST_F(SettledMotion, MetresSayNothingWithoutAScale) {
  try {
    settled("move box 50 cm to the right", std::nullopt);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.details().remedy, testing::HasSubstr("aligngs scale"));
  }
  EXPECT_DOUBLE_EQ(settled("move box by 0.5,0,0", std::nullopt).x, 0.5);
}

TEST_F(SettledMotion, TowardAThing) {
  const Vec3d shift = settled("move box 0.3 m towards pillow#1");  // to the left, and nearer
  EXPECT_NEAR(norm(shift), 0.3, 1e-6);
  EXPECT_LT(shift.x, -0.2);
  EXPECT_GT(shift.z, 0.1);
  EXPECT_GT(settled("move box 0.3 m away from pillow#1").x, 0.2);
}

TEST_F(SettledMotion, WhatIsNotOneThingIsRefused) {
  for (const char* text : {"move box 0.1 m towards the pillow", "move box 0.1 m towards the floor",
                           "move box 0.1 m towards the bed", "move box 2 m towards pillow#1"})
    EXPECT_THROW(settled(text), Error) << text;
}

}  // namespace
}  // namespace aligngs
