#include "edit/spoken_edit.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/edit_text.h"

namespace aligngs {
namespace {

TEST(SpokenEdit, CourtesiesGo) {
  for (const char* text : {"please delete the bed", "Could you delete the bed, please?", "I want to delete the bed.",
                           "I'd like to delete the bed!", "can you please delete the bed"})
    EXPECT_EQ(plain_edit(text), "delete the bed") << text;
}

TEST(SpokenEdit, ManyWordsMeanDelete) {
  for (const char* text : {"get rid of the bed", "take away the bed", "take the bed away", "throw out the bed",
                           "Erase the bed", "hide the bed", "make the bed disappear"})
    EXPECT_EQ(plain_edit(text), "delete the bed") << text;
}

TEST(SpokenEdit, OtherVerbsForDelete) {
  for (const char* text : {"lose the bed", "discard the bed", "drop the bed", "eliminate the bed", "dispose of the bed",
                           "wipe out the bed", "strip out the bed"})
    EXPECT_EQ(plain_edit(text), "delete the bed") << text;
}

TEST(SpokenEdit, DroppingSomewhereIsNoDeletion) {
  EXPECT_EQ(plain_edit("drop the lamp on the floor"), "drop the lamp on the floor");
  EXPECT_EQ(plain_edit("drop the lamp by 20 cm"), "move the lamp 20 cm down");
}

TEST(SpokenEdit, ASpinIsATurn) {
  EXPECT_EQ(parse_edit("spin the armchair 180").motion.turn, 180);
  EXPECT_EQ(parse_edit("spin the armchair around").motion.turn, 180);
}

TEST(SpokenEdit, AWardrobeIsEmptied) {
  EXPECT_EQ(plain_edit("empty the wardrobe"), "delete everything in the wardrobe");
}

TEST(SpokenEdit, ThingsAreTakenOffOthers) {
  EXPECT_EQ(plain_edit("clear the table"), "delete everything on the table");
  EXPECT_EQ(plain_edit("take the pillow off the bed"), "delete the pillow on the bed");
  EXPECT_EQ(plain_edit("remove all books from the shelf"), "delete all books on the shelf");
}

TEST(SpokenEdit, Copies) {
  for (const char* text : {"clone the lamp", "make a copy of the lamp", "create another copy of the lamp"})
    EXPECT_EQ(plain_edit(text), "copy the lamp") << text;
}

TEST(SpokenEdit, KeepOnly) {
  EXPECT_EQ(plain_edit("show me only the bed"), "keep the bed");
  EXPECT_EQ(plain_edit("show only the bed"), "keep the bed");
  EXPECT_EQ(plain_edit("only keep the bed"), "keep the bed");
  EXPECT_EQ(plain_edit("keep the bed only"), "keep the bed");
  EXPECT_EQ(plain_edit("isolate the bed"), "keep the bed");
}

TEST(SpokenEdit, AColorAtTheEndRecolors) {
  EXPECT_EQ(describe(parse_edit("make the wall light blue")), "recolor the wall to #add8e6");
  EXPECT_EQ(describe(parse_edit("turn the bed red")), "recolor the bed to #ff0000");
  EXPECT_EQ(describe(parse_edit("change the colour of the bed to red")), "recolor the bed to #ff0000");
  EXPECT_EQ(describe(parse_edit("change the bed to red")), "recolor the bed to #ff0000");
}

TEST(SpokenEdit, OtherTurnsTurn) {
  EXPECT_EQ(parse_edit("turn the armchair around").motion.turn, 180);
  EXPECT_EQ(parse_edit("turn the armchair by 45").motion.turn, 45);
  EXPECT_EQ(parse_edit("turn the armchair 90 degrees to the left").motion.turn, 90);
  EXPECT_EQ(parse_edit("turn the armchair 90 degrees to the right").motion.turn, -90);
}

TEST(SpokenEdit, MovesInWords) {
  EXPECT_EQ(parse_edit("put the armchair 1 m back").motion.shift.z, -1);
  EXPECT_EQ(parse_edit("move the armchair half a metre to the left").motion.shift.x, -0.5);
  EXPECT_EQ(parse_edit("slide the armchair a metre to the right").motion.shift.x, 1);
}

TEST(SpokenEdit, UpAndDown) {
  EXPECT_EQ(parse_edit("lift the lamp by 10 cm").motion.shift.y, 0.1);
  EXPECT_EQ(parse_edit("raise the painting 20cm").motion.shift.y, 0.2);
  EXPECT_EQ(parse_edit("lower the painting by 0.2 m").motion.shift.y, -0.2);
}

TEST(SpokenEdit, WhatIsPlainStays) {
  for (const char* text : {"delete bed, hole filled", "recolor sofa to #add8e6", "replace armchair with chair.ply",
                           "move chair by 0.5,0,-0.2 and turn by 90", "make tea"})
    EXPECT_EQ(plain_edit(text), text);
}

TEST(SpokenEdit, WordsWithoutAnEditAreRefused) { EXPECT_THROW(parse_edit("could you please"), Error); }

}  // namespace
}  // namespace aligngs
