#include "edit/object_choice.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr int kChosenChair = 19;  // ADE20K class number

/// Up is -y; the cameras look along +z, so that +x is on the right.
class ObjectChoiceTest : public small_room::LabelledBoxes {
 protected:
  size_t chosen(ObjectChoice choice) const {
    const RoomObjects objects(room_, labels_, viewpoint_, 1);
    std::vector<size_t> all;
    for (size_t i = 0; i < objects.size(); ++i) all.push_back(i);
    return chosen_object(objects, all, choice, "it");
  }
  void add_chair(float x, float z, float size, float height, int number) {
    add({x - size / 2, -height, z - size / 2}, {x + size / 2, 0, z + size / 2}, kChosenChair, number);
  }
  LabelSet labels_ = ade20k_labels();
  Viewpoint viewpoint_{Vec3d{0, -1, 0}, Vec3d{0, -1.5, -1}};
};

TEST_F(ObjectChoiceTest, SizeIsThatOfTheBoxAndNotTheNumberOfGaussians) {
  add_chair(0, 2, 0.4f, 0.4f, 1);
  add_chair(1, 3, 0.8f, 0.8f, 2);
  EXPECT_EQ(chosen(ObjectChoice::kLargest), 1u);
  EXPECT_EQ(chosen(ObjectChoice::kSmallest), 0u);
}

TEST_F(ObjectChoiceTest, StrayGaussiansDoNotMakeAChairLarge) {
  add_chair(0, 2, 0.4f, 0.4f, 1);
  add({3, -2.04f, 5}, {3.04f, -2, 5.04f}, kChosenChair, 1);  // strays of the first one
  add_chair(1, 3, 0.8f, 0.8f, 2);
  EXPECT_EQ(chosen(ObjectChoice::kLargest), 1u);
  EXPECT_EQ(chosen(ObjectChoice::kTallest), 1u);
}

TEST_F(ObjectChoiceTest, LeftAndRightAreAsThePhotosSeeIt) {
  add_chair(-0.5f, 2, 0.4f, 0.4f, 1);
  add_chair(0.5f, 2, 0.4f, 0.4f, 2);
  EXPECT_EQ(chosen(ObjectChoice::kLeft), 0u);
  EXPECT_EQ(chosen(ObjectChoice::kRight), 1u);
}

TEST_F(ObjectChoiceTest, NoneIsLeftWhereTheCamerasAreBetween) {
  viewpoint_.place = Vec3d{0, -1.5, 2};
  add_chair(-0.5f, 1, 0.4f, 0.4f, 1);
  add_chair(0.5f, 4, 0.4f, 0.4f, 2);
  EXPECT_THROW(chosen(ObjectChoice::kLeft), Error);
}

TEST_F(ObjectChoiceTest, EqualOnesAreNamed) {
  add_chair(-0.5f, 2, 0.4f, 0.4f, 1);
  add_chair(0.5f, 2, 0.4f, 0.4f, 2);
  try {
    chosen(ObjectChoice::kLargest);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("chair#1, chair#2"));
  }
}

TEST_F(ObjectChoiceTest, OneObjectNeedsNoDirection) {
  viewpoint_ = {};
  add_chair(0, 2, 0.4f, 0.4f, 1);
  EXPECT_EQ(chosen(ObjectChoice::kLeft), 0u);
  add_chair(1, 2, 0.4f, 0.4f, 2);
  EXPECT_THROW(chosen(ObjectChoice::kLeft), Error);
}

}  // namespace
}  // namespace aligngs
