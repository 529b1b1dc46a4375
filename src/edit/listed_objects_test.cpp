#include "edit/listed_objects.h"

#include <gtest/gtest.h>

#include "edit/relation/testing/bedroom.h"

namespace aligngs {
namespace {

class ObjectList : public small_room::BedroomOfBoxes {
 protected:
  EditableRoom room() const {
    EditableRoom room;
    room.gaussians = room_;
    room.labels = labels_;
    room.up = viewpoint_.up;
    return room;
  }
};

TEST_F(ObjectList, TellsTheSidesOfTheBox) {
  for (const ListedObject& object : listed_objects(room())) {
    if (object.name != "bed#2") continue;
    ASSERT_TRUE(object.sides);
    EXPECT_NEAR(object.sides->x, 1.36, 0.1) << "length";
    EXPECT_NEAR(object.sides->y, 1, 0.1) << "width";
    EXPECT_NEAR(object.sides->z, 0.5, 0.05) << "height";
    return;
  }
  FAIL() << "the list has no bed#2";
}

TEST_F(ObjectList, HasNoSizesWithoutAnUpDirection) {
  EditableRoom flat = room();
  flat.up.reset();
  for (const ListedObject& object : listed_objects(flat)) EXPECT_FALSE(object.sides) << object.name;
}

}  // namespace
}  // namespace aligngs
