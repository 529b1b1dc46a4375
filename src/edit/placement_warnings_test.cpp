#include "edit/placement_warnings.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The small room: a box of 40 cm and two flat pillows on a floor. Up is -y.
class PlacementWarnings : public testing::Test {
 protected:
  PlacementWarnings() : room_(small_room::make(pool_)) {
    room_.length_unit.metres = 1;
    Camera camera;
    camera.world_to_camera.translation = {0, 0, 3};  // at z = -3
    room_.cameras = {camera};
    for (const uint16_t l : room_.gaussians.labels.label) box_.push_back(l == small_room::kBox);
  }
  std::vector<std::string> after(const Vec3d& shift, bool copy = false) {
    Placement placement;
    placement.name = "box#1";
    placement.before = placement.after = solid_places(room_.gaussians.model, box_);
    for (Vec3d& p : placement.after) p += shift;
    placement.original_stays = copy;
    return placement_warnings(room_, box_, placement);
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  std::vector<uint8_t> box_;
};

TEST_F(PlacementWarnings, ALevelMoveToAFreePlaceSaysNothing) { EXPECT_THAT(after({0, 0, -0.6}), IsEmpty()); }

TEST_F(PlacementWarnings, AnObjectInTheAirFloats) {
  EXPECT_THAT(after({0, -0.3, -0.6}), ElementsAre(AllOf(HasSubstr("box#1 floats 30 cm"), HasSubstr("30 cm down"))));
}

TEST_F(PlacementWarnings, ThreeCentimetresAreNoFlight) { EXPECT_THAT(after({0, -0.03, -0.6}), IsEmpty()); }

TEST_F(PlacementWarnings, FeetThatNobodySawAreNoFlight) {
  for (size_t i = 0; i < box_.size(); ++i) {
    if (box_[i] && room_.gaussians.model.positions[3 * i + 1] > -0.1f) box_[i] = 0;
  }
  EXPECT_THAT(after({0, 0, -0.6}), IsEmpty());
}

TEST_F(PlacementWarnings, LegsThatNobodySawAreNoFlight) {
  for (size_t i = 0; i < box_.size(); ++i) {
    if (box_[i] && room_.gaussians.model.positions[3 * i + 1] > -0.2f) box_[i] = 0;
  }
  EXPECT_THAT(after({0, 0, -0.6}), IsEmpty());
}

TEST_F(PlacementWarnings, AThingBelowHoldsIt) { EXPECT_THAT(after({-0.56, -0.12, -0.36}), IsEmpty()); }

TEST_F(PlacementWarnings, AnObjectInAnotherCollides) {
  EXPECT_THAT(after({-0.56, 0, -0.36}), ElementsAre(HasSubstr("box#1 collides with pillow#")));
}

TEST_F(PlacementWarnings, TheWayOutIsAMoveThatHelps) {
  const std::vector<std::string> warnings = after({-0.56, 0, -0.36});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::ContainsRegex("\"move box#1 [0-9]+ cm [a-z ]+\" frees it"));
}

TEST_F(PlacementWarnings, ACopyCollidesWithItsOriginal) {
  EXPECT_THAT(after({0.1, 0, 0}, true), ElementsAre(HasSubstr("collides with box#1")));
}

TEST_F(PlacementWarnings, AMovedObjectDoesNotCollideWithItself) { EXPECT_THAT(after({0.1, 0, 0}), IsEmpty()); }

TEST_F(PlacementWarnings, LengthsHaveTheUnitOfTheRoom) {
  room_.length_unit = {};
  EXPECT_THAT(after({0, -0.3, -0.6}), ElementsAre(HasSubstr("floats 0.3 scene units above")));
}

TEST_F(PlacementWarnings, ARoomWithoutUpSaysNothing) {
  room_.up.reset();
  EXPECT_THAT(after({0, -0.3, 0}), IsEmpty());
}

}  // namespace
}  // namespace aligngs
