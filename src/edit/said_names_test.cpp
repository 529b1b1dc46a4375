// Objects as people name them, in a bedroom of boxes.
#include <gmock/gmock.h>

#include "edit/relation/testing/bedroom.h"

namespace aligngs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SaidNames : public small_room::BedroomOfBoxes {
 protected:
  SaidNames() {
    viewpoint_.place = Vec3d{0, -1.5, 0.1};
    put("wall", {-2.02f, -2.5f, 0}, {-2, 0, 4}, 2);       // on the left
    put("wall", {-2, -2.5f, -0.06f}, {2, 0, -0.04f}, 3);  // behind the cameras
    put("painting", {-0.2f, -1.8f, 3.92f}, {0.3f, -1.3f, 3.98f}, 2);
    put("painting", {0.8f, -1.8f, 3.92f}, {1.4f, -1.3f, 3.98f}, 3);
    put("book", {-0.28f, -0.9f, 3.55f}, {-0.16f, -0.8f, 3.9f});
    put("book", {0.14f, -0.86f, 3.6f}, {0.22f, -0.8f, 3.8f}, 2);
    put("cushion", {1.3f, -0.9f, 0.6f}, {1.7f, -0.8f, 1.0f});  // on chair#2
    put("stool", {-1.98f, -0.45f, 0.05f}, {-1.6f, 0, 0.4f});   // in a corner
    put("stool", {0, -0.45f, 1.9f}, {0.3f, 0, 2.2f}, 2);
    put("door", {1.0f, -2, -0.02f}, {1.9f, 0, 0.02f});
    put("curtain", {-1.9f, -2, 3.9f}, {-1.6f, -0.02f, 3.96f});
    paint("chair", 1, {0.7f, 0.15f, 0.1f});
    paint("chair", 2, {0.9f, 0.9f, 0.88f});
    paint("pillow", 1, {0.15f, 0.25f, 0.6f});
    paint("pillow", 2, {0.93f, 0.93f, 0.93f});
    paint("pillow", 3, {0.4f, 0.27f, 0.14f});
  }
  void paint(const char* name, int number, const Vec3f& color) {
    for (size_t i = 0; i < room_.model.size(); ++i) {
      if (room_.labels.label[i] != labels_.find(name) || room_.labels.instance[i] != number) continue;
      for (size_t c = 0; c < 3; ++c)
        room_.model.sh[3 * kShCoefficients * i + c] = (color[static_cast<int>(c)] - 0.5f) / static_cast<float>(kSh0);
    }
  }
  void expect_all(const std::string& means, std::initializer_list<const char*> texts) const {
    for (const char* text : texts) EXPECT_EQ(meant(text), means) << text;
  }
};

TEST_F(SaidNames, TheMiddleOne) {
  expect_all("painting#2",
             {"the middle painting", "the painting in the middle", "the central painting", "Painting in the centre",
              "the center painting", "the middle one of the three paintings", "the middle of the paintings"});
  EXPECT_THAT(refusal("the middle chair"), AllOf(HasSubstr("no middle one"), HasSubstr("or \"chair#2\"?")));
}

TEST_F(SaidNames, InTheCorner) {
  expect_all("stool#1", {"the stool in the corner", "the corner stool", "stool in a corner",
                         "the stool in the corner of the room", "the stool that's in the corner"});
  EXPECT_THAT(refusal("the pillow in the corner"), HasSubstr("no object is"));
}

TEST_F(SaidNames, InTheMiddleOfTheRoom) {
  expect_all("stool#2", {"the stool in the middle of the room", "stool in the centre of the room"});
}

TEST_F(SaidNames, NearestAndFarthest) {
  expect_all("chair#1", {"the chair furthest from chair#2", "the chair farthest from the door",
                         "the furthest chair from the door", "the chair most distant from the door",
                         "the chair farthest away from the door", "the second nearest chair to the door"});
  expect_all("chair#2", {"the chair nearest the door", "the closest chair to the door", "the chair closest the door",
                         "the nearest chair to the door", "the second chair farthest from the door"});
  expect_all("painting#1, painting#2", {"the two paintings nearest bed#1", "the two nearest paintings to bed#1"});
  EXPECT_THAT(refusal("the pillow furthest from the bed"), HasSubstr("did you mean \"bed#1\" or \"bed#2\"?"));
  EXPECT_THAT(refusal("the paintings nearest bed#1"), HasSubstr("how many"));
  EXPECT_THAT(refusal("the nearest chair"), HasSubstr("to what"));
}

TEST_F(SaidNames, InARow) {
  expect_all("painting#2", {"the second painting from the left", "the 2nd painting from left",
                            "the second painting from the right", "the second painting on the wall from the left"});
  expect_all("painting#3", {"the first painting from the right", "the last painting from the left",
                            "the third painting from the left"});
  EXPECT_EQ(meant("the first two paintings from the left"), "painting#1, painting#2");
  EXPECT_THAT(refusal("the painting from the left"), HasSubstr("how many to count"));
}

TEST_F(SaidNames, OneOfSeveral) {
  expect_all("book#2", {"the smallest of the books", "the smallest one of the books", "the smaller of the two books",
                        "the smallest of my books", "the tiny book", "the little book",
                        "the smaller one of the two books on the dresser"});
  EXPECT_THAT(refusal("the larger of the three books"), HasSubstr("did you mean \"book#1\" or \"book#2\"?"));
  EXPECT_THAT(refusal("one of the lamps"), HasSubstr("did you mean \"lamp#1\" or \"lamp#2\"?"));
  EXPECT_THAT(refusal("either lamp"), HasSubstr("means one of them"));
}

TEST_F(SaidNames, Sides) {
  expect_all("lamp#2", {"the left-hand lamp", "the lamp on the left-hand side", "the lamp on the far left",
                        "the left of the two lamps", "the far left lamp"});
  expect_all("pillow#2", {"the pillow on the left side of bed#2", "the pillow on the left half of bed#2"});
  EXPECT_EQ(meant("the beds on both sides of the chest of drawers"), "bed#1, bed#2");
  EXPECT_THAT(refusal("the bed on either side of the chest of drawers"), HasSubstr("means one of them"));
}

TEST_F(SaidNames, TwoAdjectivesOfOneName) {
  expect_all("lamp#1, lamp#2", {"the left and right lamps", "the left and the right lamp", "a pair of lamps",
                                "the first and second lamp", "Both Lamps", "both of the lamps"});
  EXPECT_EQ(meant("the red and white chairs"), "chair#1, chair#2");
}

TEST_F(SaidNames, Colours) {
  expect_all("chair#1", {"the red chair", "Red chair", "the red-coloured chair", "the red colored chair",
                         "the chair on the left and the red chair"});
  EXPECT_EQ(meant("every chair but the white one"), "chair but chair#2");
  expect_all("pillow#1", {"the blue pillow", "the dark blue pillow", "the bluish pillow"});
  EXPECT_EQ(meant("the white pillow on bed#2"), "pillow#2");
  EXPECT_EQ(meant("the cushion on the white chair"), "cushion#1");
  EXPECT_EQ(meant("the lightest pillow"), "pillow#2");
}

TEST_F(SaidNames, AnotherColourIsRefused) {
  EXPECT_THAT(refusal("the green chair"), AllOf(HasSubstr("chair#1 is red, chair#2 is white"),
                                                HasSubstr("did you mean \"chair#1\" or \"chair#2\"?")));
  EXPECT_THAT(refusal("the gray lamp"), HasSubstr("means one of them"));
}

TEST_F(SaidNames, NotInAPlace) {
  expect_all("pillow#1", {"the pillows not on bed#2", "pillows that aren't on bed#2", "the pillow not on bed#2",
                          "every pillow that is not on bed#2"});
}

TEST_F(SaidNames, AllButSome) {
  expect_all("lamp but lamp#2", {"all lamps, not lamp#2", "all lamps and not lamp#2", "lamps save lamp#2",
                                 "all lamps with the exception of lamp#2", "all lamps not including lamp#2"});
  expect_all("everything but wall", {"everything but the walls", "Everything except the walls"});
}

TEST_F(SaidNames, OwnersAndContents) {
  expect_all("pillow#2, pillow#3", {"bed#2's pillows", "the contents of bed#2"});
  EXPECT_EQ(meant("the beds and the pillows on them"), "bed, pillow#1-3");
  EXPECT_EQ(meant("the pillows of the right bed"), "pillow#2, pillow#3");
}

TEST_F(SaidNames, OneThingHoldsAnother) {
  expect_all("chair#2", {"the chair with the cushion on it", "the chair that has a cushion on it",
                         "the chair holding the cushion", "the chair with the cushion on top"});
  EXPECT_THAT(refusal("the chair with the cushion"), HasSubstr("did you mean \"the chair, the cushion\" or"));
}

TEST_F(SaidNames, ItIsTheThingBefore) {
  EXPECT_EQ(meant("the white chair and the cushion on it"), "chair#2, cushion#1");
  EXPECT_THAT(refusal("the lamp on the dresser and the chair next to it"), HasSubstr("may mean two things"));
}

TEST_F(SaidNames, NamesThatTellAPlace) {
  expect_all("lamp#2", {"the floor lamp", "the standing lamp", "floor lamps"});
  expect_all("lamp#1", {"the table lamp", "the bedside lamp", "the desk lamp"});
}

TEST_F(SaidNames, TheRoomItself) {
  EXPECT_EQ(meant("the lamp on the dresser in the room"), "lamp#1");
  EXPECT_EQ(meant("everything in the room"), meant("all things"));
}

TEST_F(SaidNames, DoorsAndCurtainsAreNoThingsOnTheFloor) {
  const std::string found = meant("everything on the floor");
  EXPECT_EQ(found.find("door"), std::string::npos) << found;
  EXPECT_EQ(found.find("curtain"), std::string::npos) << found;
  EXPECT_THAT(found, HasSubstr("chair#1, chair#2"));
}

TEST_F(SaidNames, DoorsAreNoThingsOnTheWall) {
  put("door", {-1.0f, -2, 3.96f}, {-0.5f, 0, 4.0f}, 2);
  const std::string found = meant("everything on the wall");
  EXPECT_EQ(found.find("door"), std::string::npos) << found;
  EXPECT_THAT(found, HasSubstr("painting#1-3"));
  EXPECT_THAT(meant("all doors on the wall"), HasSubstr("door#2"));
}

TEST_F(SaidNames, AllThingsAreWithoutDoors) { EXPECT_EQ(meant("all things").find("door"), std::string::npos); }

}  // namespace
}  // namespace aligngs
