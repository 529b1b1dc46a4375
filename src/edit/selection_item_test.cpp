#include "edit/selection_item.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/selection_text.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

const Vocabulary& ade20k_words() {
  static const Vocabulary vocabulary(ade20k_labels());
  return vocabulary;
}

/// As messages say it, before any object is found.
std::string understood(const std::string& text) {
  return selection_text(parse_selection(text, ade20k_words()), ade20k_labels());
}

std::string usage_error(const std::string& text) {
  try {
    ADD_FAILURE() << "accepted: " << understood(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    return error.details().message + " | " + error.details().remedy;
  }
  return "";
}

TEST(SelectionItem, AThingWithAPlaceIsOne) {
  for (const char* text : {"the pillow on the bed", "pillow on bed", "my pillow that is on top of the bed",
                           "the pillow lying on the bed", "Pillow ON the bed"})
    EXPECT_EQ(understood(text), "pillow on bed") << text;
}

TEST(SelectionItem, PluralsAndQuantifiersAreAny) {
  for (const char* text : {"pillows on the bed", "the pillows on the bed", "all pillows on the bed",
                           "every pillow on the bed", "any pillow on the bed"})
    EXPECT_EQ(understood(text), "all pillow on bed") << text;
}

TEST(SelectionItem, CountsAreKept) {
  EXPECT_EQ(understood("both pillows on the bed"), "2 x pillow on bed");
  EXPECT_EQ(understood("the three chairs"), "3 x chair");
  EXPECT_EQ(understood("both the bed and the lamp"), "bed, lamp");
}

TEST(SelectionItem, AThingIsOne) {
  EXPECT_EQ(parse_selection("a lamp", ade20k_words()).include[0].count, 1);
  EXPECT_EQ(parse_selection("one lamp", ade20k_words()).include[0].count, 1);
  EXPECT_EQ(parse_selection("lamp", ade20k_words()).include[0].count, 0) << "all of the class";
  EXPECT_EQ(understood("a large lamp"), "largest lamp");
  EXPECT_EQ(understood("a lamp on the table"), "lamp on table");
}

TEST(SelectionItem, WordsOfOneRelation) {
  for (const char* text : {"lamp next to the sofa", "lamp beside the sofa", "lamp by the sofa", "lamp at the sofa"})
    EXPECT_EQ(understood(text), "lamp next to sofa") << text;
  for (const char* text : {"chair near the window", "chair close to the window"})
    EXPECT_EQ(understood(text), "chair near windowpane") << text;
  EXPECT_EQ(understood("chair to the left of the bed"), "chair left of bed");
  EXPECT_EQ(understood("chair on the right side of the bed"), "chair on the right side of bed");
  EXPECT_EQ(understood("rug underneath the table"), "rug under table");
  EXPECT_EQ(understood("the chair closest to the door"), "chair nearest to door");
}

TEST(SelectionItem, BetweenHasTwoSides) {
  EXPECT_EQ(understood("the chair between the table and the window"), "chair between table and windowpane");
  EXPECT_EQ(understood("lamps in between the bed and the wardrobe"), "all lamp between bed and wardrobe");
  EXPECT_EQ(understood("the chest between the two beds"), "chest of drawers between 2 x bed");
  EXPECT_EQ(understood("the lamp on the table between the bed and the wall"), "lamp on table between bed and wall");
  EXPECT_EQ(understood("the chair between the bed and the lamp on the desk"), "chair between bed and lamp on desk");
}

TEST(SelectionItem, AndAfterBothSidesBeginsAnotherItem) {
  EXPECT_EQ(understood("the chair between the table and the window and the lamp"),
            "chair between table and windowpane, lamp");
  EXPECT_EQ(understood("the bed and the chair between the table and the window"),
            "bed, chair between table and windowpane");
}

TEST(SelectionItem, BetweenOneThingIsNoPlace) {
  EXPECT_THAT(usage_error("the chair between the table"), HasSubstr("between the bed and the window"));
}

TEST(SelectionItem, SidesAreNoPlaces) {
  EXPECT_EQ(understood("the pillow on the left"), "left pillow");
  EXPECT_EQ(understood("the chair to the right"), "right chair");
  EXPECT_EQ(understood("the pillow on the left bed"), "pillow on left bed");
  EXPECT_EQ(understood("the pillow on the bed on the left side"), "left pillow on bed");
}

TEST(SelectionItem, GroupsOfClasses) {
  EXPECT_EQ(understood("all furniture"), "furniture");
  EXPECT_EQ(understood("everything on the table"), "all things on table");
  EXPECT_EQ(understood("what is on the table"), "all things on table");
  EXPECT_EQ(understood("the largest piece of furniture"), "largest furniture");
  EXPECT_EQ(understood("the thing on the table"), "things on table");
}

TEST(SelectionItem, SeveralOfTheLargest) {
  for (const char* text : {"the two largest chairs", "the largest two chairs", "largest 2 chairs",
                           "both largest chairs", "the 2 biggest chairs"})
    EXPECT_EQ(understood(text), "2 largest chair") << text;
  EXPECT_EQ(understood("the three smallest pillows on the bed"), "3 smallest pillow on bed");
}

TEST(SelectionItem, TheSecondLargest) {
  EXPECT_EQ(understood("the second largest chair"), "2nd largest chair");
  EXPECT_EQ(understood("the second-largest chair"), "2nd largest chair");
  EXPECT_EQ(understood("3rd smallest chair"), "3rd smallest chair");
  EXPECT_EQ(understood("the first largest chair"), "largest chair");
}

TEST(SelectionItem, PlacesNest) {
  EXPECT_EQ(understood("the lamp on the table near the window"), "lamp on table near windowpane");
  EXPECT_THAT(usage_error("a lamp on a table near a bed by a door under a window"), HasSubstr("three places"));
}

TEST(SelectionItem, ListsAndExceptions) {
  EXPECT_EQ(understood("the pillow on the bed, the lamp"), "lamp, pillow on bed");
  EXPECT_EQ(understood("everything on the table but the lamp"), "all things on table but lamp");
  EXPECT_THAT(understood("the books on the table and on the bed"),
              testing::AllOf(HasSubstr("all book on table"), HasSubstr("all book on bed")));
}

TEST(SelectionItem, AConjunctionAfterAPlaceHasTwoReadings) {
  EXPECT_THAT(usage_error("the pillows on the bed and the sofa"),
              testing::AllOf(HasSubstr("two readings"), HasSubstr("\"the pillows on the bed, the sofa\"")));
}

TEST(SelectionItem, APlaceAfterTwoNamesHasTwoReadings) {
  EXPECT_THAT(usage_error("the pillows and the cushions on the armchair"),
              testing::AllOf(HasSubstr("two readings"), HasSubstr("\"the pillows, the cushions on the armchair\""),
                             HasSubstr("\"the pillows on the armchair, the cushions on the armchair\"")));
  EXPECT_THAT(usage_error("the lamp and the book on the left nightstand"), HasSubstr("two readings"));
  EXPECT_THAT(usage_error("books, pillows and cushions next to the sofa"), HasSubstr("two readings"));
}

TEST(SelectionItem, APlaceThatOneNameCannotHaveIsThatOfTheOther) {
  EXPECT_EQ(understood("the desk and the lamp on the desk"), "desk, lamp on desk");
  EXPECT_EQ(understood("the armchair and the lamp on the table"), "armchair, lamp on table");
  EXPECT_EQ(understood("the wall and the lamp on the table"), "wall, lamp on table");
  EXPECT_EQ(understood("the sofa and the painting on the wall above the bed"), "painting on wall above bed, sofa");
  EXPECT_EQ(understood("pillow#1 and the cushion on the armchair"), "cushion on armchair, pillow#1");
  EXPECT_EQ(understood("the lamp and everything on the desk"), "all things on desk, lamp");
}

TEST(SelectionItem, APlaceAfterAWallIsASecondOne) {
  EXPECT_EQ(understood("the paintings on the wall above the bed"), "all painting on wall above bed");
  EXPECT_EQ(understood("the lamp on the table above the bed"), "lamp on table above bed") << "the table's place";
}

TEST(SelectionItem, EverySecondOneIsNotTheSecond) {
  EXPECT_THAT(usage_error("every second book"), testing::AllOf(HasSubstr("two readings"), HasSubstr("book#2")));
  EXPECT_THAT(usage_error("every 3rd pillow on the bed"), HasSubstr("two readings"));
}

TEST(SelectionItem, SizesOfManyAskForACount) {
  EXPECT_THAT(usage_error("tall furniture"), HasSubstr("the two tallest pieces of furniture"));
  for (const char* text : {"big furniture", "the small things on the bed", "all small things", "every large lamp"})
    EXPECT_THAT(usage_error(text), HasSubstr("how many")) << text;
  EXPECT_EQ(understood("the two largest pieces of furniture"), "2 largest furniture");
}

TEST(SelectionItem, ASideOfManyAsksForACount) {
  EXPECT_THAT(usage_error("the pillows on the bed on the left"), HasSubstr("how many"));
  EXPECT_THAT(usage_error("everything on the table on the right"), HasSubstr("how many"));
  EXPECT_EQ(understood("the thing on the table on the right"), "right things on table");
}

TEST(SelectionItem, WordsAreNoClasses) {
  EXPECT_THAT(usage_error("the left one"), HasSubstr("\"the left lamp\""));
  EXPECT_THAT(usage_error("the plate nearest to me"), HasSubstr("no thing of the room"));
}

TEST(SelectionItem, AnAdjectiveMayFollow) {
  EXPECT_EQ(understood("the lamp that is bigger"), "largest lamp");
  EXPECT_EQ(understood("the lamp which is on the left"), "left lamp");
}

TEST(SelectionItem, AThingWithItsThingsHasTwoReadings) {
  EXPECT_THAT(usage_error("the bed with its pillows"), HasSubstr("\"the bed with the pillows on it\""));
}

TEST(SelectionItem, QuotesWithinWordsSayNothing) {
  EXPECT_EQ(understood("the \"sofa\""), "sofa");
  EXPECT_EQ(understood("the \xe2\x80\x9csofa\xe2\x80\x9d"), "sofa");
}

TEST(SelectionItem, WhatIsUnclearIsRefused) {
  EXPECT_THAT(usage_error("the pilow on the bed"), HasSubstr("did you mean \"pillow\""));
  EXPECT_THAT(usage_error("the pillow on the bedd"), HasSubstr("did you mean \"bed\""));
  EXPECT_THAT(usage_error("the other chair"), HasSubstr("every chair but chair#1"));
  EXPECT_THAT(usage_error("the second pillow on the bed"), HasSubstr("whole room"));
  EXPECT_THAT(usage_error("the largest chairs"), HasSubstr("the two largest chairs"));
  EXPECT_THAT(usage_error("the left curtains"), HasSubstr("how many"));
  EXPECT_THAT(usage_error("the second largest two chairs"), HasSubstr("one object"));
  for (const char* text : {"on the bed", "the pillow on", "everything but everything", "the pillow on the"})
    usage_error(text);
}

}  // namespace
}  // namespace aligngs
