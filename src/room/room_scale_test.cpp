#include "room/room_scale.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "room/testing/sample_room.h"

namespace aligngs {
namespace {

TEST(RoomScale, AKnownDoorSetsTheScaleOfEverything) {
  MeasuredRoom room = sample_room::make();
  room.metric = false;
  const MeasuredRoom scaled = scaled_to(room, measured_side(room, "door", KnownSide::kHeight), 2.2);
  EXPECT_TRUE(scaled.metric);
  EXPECT_EQ(scaled.scale_source, ScaleSource::kGiven);
  EXPECT_NEAR(scaled.height, 2.75, 1e-12);
  EXPECT_NEAR(scaled.to_room.scale, 1.1, 1e-12);
}

TEST(RoomScale, TheSameLengthAgainChangesNothing) {
  const MeasuredRoom room = sample_room::make();
  const double measured = measured_side(room, "door", KnownSide::kHeight) / 3;
  const MeasuredRoom once = scaled_to(room, measured, 0.7);
  // The length as it is measured in the scaled room, with the rounding of another order of products.
  const MeasuredRoom twice = scaled_to(once, 0.7 * (1 + 4e-16), 0.7);
  EXPECT_EQ(twice.to_room.scale, once.to_room.scale);
  EXPECT_EQ(twice.height, once.height);
}

TEST(RoomScale, EverythingWithALengthHasAName) {
  const MeasuredRoom room = sample_room::make();
  EXPECT_DOUBLE_EQ(measured_side(room, "wall.1", KnownSide::kLength), 4);
  EXPECT_DOUBLE_EQ(measured_side(room, "ceiling", KnownSide::kHeight), 2.5);
  EXPECT_DOUBLE_EQ(measured_side(room, "sofa.1", KnownSide::kDepth), 0.9);
  EXPECT_NEAR(measured_side(room, "window.1", KnownSide::kWidth), 1.2, 1e-12);
}

TEST(RoomScale, UnknownAndAmbiguousNamesAreErrors) {
  const MeasuredRoom room = sample_room::make();
  EXPECT_THROW(measured_side(room, "piano", KnownSide::kHeight), Error);
  EXPECT_THROW(measured_side(room, "wall", KnownSide::kLength), Error) << "there are four";
  EXPECT_THROW(measured_side(room, "door.1", KnownSide::kDepth), Error) << "a door has none";
}

TEST(RoomScale, LengthsMustBePositiveAndFinite) {
  const MeasuredRoom room = sample_room::make();
  for (const double wrong :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 2e4, 5e-5}) {
    EXPECT_THROW(scaled_to(room, 1, wrong), Error) << wrong;
  }
  EXPECT_THROW(scaled_to(room, 0, 1), Error);
}

}  // namespace
}  // namespace aligngs
