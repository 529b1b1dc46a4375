#include "edit/out_of_room.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// The small room: a floor of 2.4 m by 1.6 m without walls.
class OutOfRoom : public testing::Test {
 protected:
  OutOfRoom() : room_(small_room::make(pool_)) {
    room_.length_unit.metres = 1;
    for (const uint16_t l : room_.gaussians.labels.label) box_.push_back(l == small_room::kBox);
  }
  std::string after(const Vec3d& shift) {
    Placement placement{"box#1", solid_places(room_.gaussians.model, box_), {}};
    for (const Vec3d& place : placement.before) placement.after.push_back(place + shift);
    return out_of_room(room_, box_, placement);
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  std::vector<uint8_t> box_;
};

TEST_F(OutOfRoom, AMotionInsideSaysNothing) {
  EXPECT_EQ(after({0.5, 0, 0}), "");
  EXPECT_EQ(after({0, -1, 0}), "") << "nothing is above";
}

TEST_F(OutOfRoom, BelowTheFloor) { EXPECT_THAT(after({0, 0.3, 0}), HasSubstr("below the floor")); }

TEST_F(OutOfRoom, AnObjectInThePlaceOfAnotherMayBeTooLarge) {
  Placement placement{"sofa#1", solid_places(room_.gaussians.model, box_), {}};
  for (int k = 0; k < 100; ++k) placement.after.push_back({0.05 * k, -0.2, 0});
  EXPECT_THAT(out_of_room(room_, box_, placement), StartsWith("sofa#1 reaches "));
}

TEST_F(OutOfRoom, BesideTheRoom) { EXPECT_THAT(after({3, 0, 0}), HasSubstr("out of the room")); }

TEST_F(OutOfRoom, LengthsHaveTheUnitOfTheRoom) {
  EXPECT_THAT(after({0, 0.3, 0}), HasSubstr(" cm "));
  room_.length_unit = {};
  EXPECT_THAT(after({0, 0.3, 0}), HasSubstr("scene units"));
  room_.length_unit = {2, true};
  EXPECT_THAT(after({0, 0.3, 0}), HasSubstr(" cm (estimated) "));
}

}  // namespace
}  // namespace aligngs
