#include "edit/length_unit.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(LengthUnit, SidesAreCentimetresWhereTheScaleIsKnown) {
  EXPECT_EQ(sides_text({0.77, 0.5, 1.804}, {1.0, false}), "77 x 50 x 180 cm");
  EXPECT_EQ(sides_text({0.77, 0.5, 1.8}, {2.0, false}), "154 x 100 x 360 cm");
  EXPECT_EQ(sides_text({0.77, 0.5, 1.8}, {}), "0.77 x 0.50 x 1.80 units");
}

TEST(LengthUnit, EstimatesOfANetworkAreCalledSo) {
  EXPECT_EQ(length_text(0.46, {1.0, false}), "46 cm");
  EXPECT_EQ(length_text(0.46, {1.0, true}), "46 cm (estimated)");
  EXPECT_EQ(length_text(0.46, {}), "0.46 scene units");
}

TEST(LengthUnit, WhatIsTypedHasNoRemark) {
  EXPECT_EQ(length_to_type(0.46, {1.0, true}), "46 cm");
  EXPECT_EQ(length_to_type(0.46, {}), "0.46");
}

TEST(LengthUnit, IsThatOfTheSceneWithoutAMeasuredRoom) {
  Scene scene;
  EXPECT_FALSE(length_unit_of("/nowhere", scene).metres);
  scene.metric = true;
  EXPECT_EQ(length_unit_of("/nowhere", scene).metres, 1);
  EXPECT_FALSE(length_unit_of("/nowhere", scene).estimated);
  scene.units_estimate.emplace();
  EXPECT_TRUE(length_unit_of("/nowhere", scene).estimated);
}

}  // namespace
}  // namespace aligngs
