#include "edit/meant_objects.h"

#include <gmock/gmock.h>

#include "edit/relation/testing/bedroom.h"

namespace aligngs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MeantObjectsTest : public small_room::BedroomOfBoxes {};

TEST_F(MeantObjectsTest, OneThingOnAnother) {
  EXPECT_EQ(meant("the pillow on bed#1"), "pillow#1");
  EXPECT_EQ(meant("the lamp on the chest of drawers"), "lamp#1");
  EXPECT_EQ(meant("lamp standing on top of the dresser"), "lamp#1");
}

TEST_F(MeantObjectsTest, OneIsNotGuessedAmongSeveral) {
  EXPECT_THAT(refusal("the pillow on bed#2"), AllOf(HasSubstr("pillow#2, pillow#3"), HasSubstr("all")));
}

TEST_F(MeantObjectsTest, TheBedIsNotGuessedAmongSeveral) {
  EXPECT_THAT(refusal("the pillows on the bed"),
              AllOf(HasSubstr("pillow#1 by bed#1"), HasSubstr("pillow#3 by bed#2"), HasSubstr("on bed#1")));
  EXPECT_EQ(meant("the pillows on the beds"), "pillow#1-3");
}

TEST_F(MeantObjectsTest, PiecesThatLieCloseTogetherAreOneThing) {
  put("bed", {-0.35f, -0.5f, 2.6f}, {0.35f, 0, 3.45f}, 3);  // between the two others
  put("pillow", {-0.2f, -0.62f, 3.0f}, {0.2f, -0.5f, 3.3f}, 4);
  EXPECT_EQ(meant("the pillows on the bed"), "pillow#1-4");
}

TEST_F(MeantObjectsTest, AllOfThem) {
  EXPECT_EQ(meant("the pillows on bed#2"), "pillow#2, pillow#3");
  EXPECT_EQ(meant("every pillow on any bed"), "pillow#1-3");
  EXPECT_EQ(meant("all pillows on the right bed"), "pillow#2, pillow#3");
}

TEST_F(MeantObjectsTest, TheFirstOfAChoice) {
  EXPECT_EQ(meant("the two left pillows"), "pillow#1, pillow#2");
  EXPECT_EQ(meant("the second left pillow"), "pillow#2");
  EXPECT_EQ(meant("the second largest chair"), "chair#1");
  EXPECT_EQ(meant("the two largest chairs"), "chair#1, chair#2");
  EXPECT_THAT(refusal("the two largest pillows"), HasSubstr("alike: pillow#2, pillow#3"));
  EXPECT_THAT(refusal("the second largest pillow"), HasSubstr("alike"));
  EXPECT_THAT(refusal("the three largest chairs"), HasSubstr("means 3 of them, and 2 fit"));
  EXPECT_THAT(refusal("the third largest chair"), HasSubstr("there is no"));
}

TEST_F(MeantObjectsTest, NoWallIsTheLeftOne) {
  for (const char* text : {"the left wall", "the largest wall", "the paintings on the left wall", "the left floor"})
    EXPECT_THAT(refusal(text), HasSubstr("not told from the rest")) << text;
}

TEST_F(MeantObjectsTest, CountsAreChecked) {
  EXPECT_EQ(meant("both pillows on bed#2"), "pillow#2, pillow#3");
  EXPECT_EQ(meant("both lamps"), "lamp#1, lamp#2");
  EXPECT_EQ(meant("the three pillows"), "pillow#1-3");
  EXPECT_THAT(refusal("both pillows"), HasSubstr("means 2 of them, and 3 fit: pillow#1, pillow#2, pillow#3"));
}

TEST_F(MeantObjectsTest, EverythingOnSomething) {
  EXPECT_EQ(meant("everything on bed#2"), "pillow#2, pillow#3");
  EXPECT_EQ(meant("all that is on the dresser"), "lamp#1");
  EXPECT_EQ(meant("the things on bed#2 but pillow#3"), "pillow#2, pillow#3 but pillow#3");
}

TEST_F(MeantObjectsTest, AGroupIsItsClasses) {
  EXPECT_EQ(meant("all furniture"), "bed, chair, chest of drawers");
  EXPECT_EQ(meant("the furniture next to the wall"), "bed#1, bed#2, chest of drawers#1");
  EXPECT_EQ(meant("all furniture but the beds"), "bed, chair, chest of drawers but bed");
}

TEST_F(MeantObjectsTest, NextToTakesTheClearlyNearestOne) {
  EXPECT_EQ(meant("the lamp next to the chair"), "lamp#2");
  EXPECT_EQ(meant("the chair beside lamp#2"), "chair#1");
  EXPECT_EQ(meant("the bed nearest to chair#2"), "bed#2");
  EXPECT_THAT(refusal("the bed next to the chest"), AllOf(HasSubstr("bed#1 (0.2"), HasSubstr("bed#2 (0.2")));
}

TEST_F(MeantObjectsTest, AboveAndUnder) {
  EXPECT_EQ(meant("the painting above the bed"), "painting#1");
  EXPECT_EQ(meant("the rug under bed#2"), "rug#1");
  EXPECT_EQ(meant("the bed under the painting"), "bed#1");
}

TEST_F(MeantObjectsTest, WallsAndFloor) {
  EXPECT_EQ(meant("everything on the wall"), "painting#1");
  EXPECT_EQ(meant("all lamps on the floor"), "lamp#2");
}

TEST_F(MeantObjectsTest, FurnitureStandsWhereItsFootIsNotSeen) {
  put("wardrobe", {-2.0f, -2.0f, 3.4f}, {-1.6f, -0.16f, 3.98f});
  EXPECT_EQ(meant("everything on the wall"), "painting#1");
  EXPECT_EQ(meant("all wardrobes on the floor"), "wardrobe#1");
}

TEST_F(MeantObjectsTest, ABoxOnAWardrobeHangsOnNoWall) {
  put("wardrobe", {-2.0f, -2.0f, 3.4f}, {-1.6f, 0, 3.98f});
  put("box", {-1.95f, -2.3f, 3.5f}, {-1.65f, -2.0f, 3.97f});
  EXPECT_EQ(meant("everything on the wall"), "painting#1");
}

TEST_F(MeantObjectsTest, ACabinetOnTheWallHangs) {
  put("cabinet", {-0.3f, -1.9f, 3.6f}, {0.3f, -1.4f, 3.98f});
  EXPECT_EQ(meant("everything on the wall"), "cabinet#1, painting#1");
}

TEST_F(MeantObjectsTest, APlantStandsInItsPot) {
  put("pot", {1.7f, -0.4f, 3.6f}, {1.95f, 0, 3.9f});
  put("plant", {1.65f, -1.2f, 3.55f}, {1.95f, -0.42f, 3.95f});
  EXPECT_EQ(meant("everything on the wall"), "painting#1");
  EXPECT_EQ(meant("all plants on the floor"), "plant#1");
}

TEST_F(MeantObjectsTest, OnTheTopOfAWardrobeIsNotInIt) {
  put("wardrobe", {-2.0f, -2.0f, 3.4f}, {-1.6f, 0, 3.98f});
  put("box", {-1.95f, -2.3f, 3.5f}, {-1.65f, -2.0f, 3.9f});
  EXPECT_EQ(meant("the box on the wardrobe"), "box#1");
  EXPECT_THAT(refusal("the box in the wardrobe"), HasSubstr("no object is \"box in wardrobe\""));
  EXPECT_THAT(refusal("the contents of the wardrobe"), HasSubstr("no object is"));
}

TEST_F(MeantObjectsTest, WhatAThingOwnsIsAlsoOnItsTop) {
  EXPECT_EQ(meant("the dresser's lamp"), "lamp#1");
  EXPECT_EQ(meant("the lamp of the chest of drawers"), "lamp#1");
}

TEST_F(MeantObjectsTest, SeatingIsAGroup) {
  put("sofa", {-0.3f, -0.8f, 1.0f}, {0.4f, 0, 1.6f});
  EXPECT_EQ(meant("all seating"), "chair, sofa");
}

TEST_F(MeantObjectsTest, APlaceAfterTheWallIsThatOfTheThings) {
  put("painting", {0.7f, -1.8f, 3.92f}, {1.3f, -1.3f, 3.98f}, 2);
  EXPECT_EQ(meant("the paintings on the wall above bed#2"), "painting#2");
  EXPECT_EQ(meant("everything on the wall above bed#1"), "painting#1");
  EXPECT_EQ(meant("all lamps on the floor next to chair#1"), "lamp#2");
  EXPECT_EQ(meant("the paintings on the wall not above bed#2"), "painting#1");
  EXPECT_THAT(refusal("the lamp on the wall above bed#1"), HasSubstr("no object is \"lamp on wall\""));
}

TEST_F(MeantObjectsTest, NotOnAWallInAPlaceHasTwoReadings) {
  EXPECT_THAT(refusal("the paintings not on the wall above bed#1"), HasSubstr("two readings"));
}

TEST_F(MeantObjectsTest, SidesAreThoseOfTheCameras) {
  EXPECT_EQ(meant("the bed to the left of the chest of drawers"), "bed#1");
  EXPECT_EQ(meant("the bed right of the chest of drawers"), "bed#2");
  EXPECT_EQ(meant("the chair in front of bed#2"), "chair#2");
  EXPECT_EQ(meant("the bed behind chair#2"), "bed#2");
}

TEST_F(MeantObjectsTest, BetweenTwoThings) {
  EXPECT_EQ(meant("the chest of drawers between the beds"), "chest of drawers#1");
  EXPECT_EQ(meant("the chest of drawers between bed#2 and bed#1"), "chest of drawers#1");
  EXPECT_EQ(meant("the rug between the chest of drawers and chair#2"), "rug#1");
  EXPECT_THAT(refusal("the chair between the beds"), AllOf(HasSubstr("chest of drawers#1"), HasSubstr("chair#1")));
}

TEST_F(MeantObjectsTest, BetweenAThingAndTheWallBehindIt) {
  put("stool", {-0.2f, -0.5f, 3.2f}, {0.2f, 0, 3.4f});
  put("table", {-0.4f, -0.7f, 1.0f}, {0.4f, 0, 1.8f});
  EXPECT_EQ(meant("the stool between the table and the wall"), "stool#1");
}

TEST_F(MeantObjectsTest, SizesOfThoseInAPlace) {
  EXPECT_EQ(meant("the tallest lamp"), "lamp#2");
  EXPECT_EQ(meant("the shortest lamp"), "lamp#1");
  EXPECT_EQ(meant("the widest chair"), "chair#2");
  EXPECT_EQ(meant("the left pillow on bed#2"), "pillow#2");
  EXPECT_EQ(meant("the pillow on bed#2 on the right"), "pillow#3");
  EXPECT_EQ(meant("the biggest thing on the bed nearest to chair#1"), "pillow#1");
}

TEST_F(MeantObjectsTest, NothingFits) {
  EXPECT_THAT(refusal("the lamp on bed#1"), AllOf(HasSubstr("no object is \"lamp on bed#1\""),
                                                  HasSubstr("it fits: pillow#1"), HasSubstr("lamp#1 (")));
  EXPECT_THAT(refusal("the sofa on the bed"), AllOf(HasSubstr("sofa"), HasSubstr("it holds bed#1")));
  EXPECT_THAT(refusal("the pillow on the sofa"), AllOf(HasSubstr("no object that is \"sofa\""), HasSubstr("it holds")));
}

TEST_F(MeantObjectsTest, WithoutAnUpDirectionGapsStillCount) {
  viewpoint_ = {};
  EXPECT_EQ(meant("the lamp next to chair#1"), "lamp#2");
  EXPECT_THAT(refusal("the pillow on the bed"), HasSubstr("which way is up"));
}

}  // namespace
}  // namespace aligngs
