#include "edit/nearest_readings.h"

#include <gmock/gmock.h>

#include "edit/edit_text.h"
#include "edit/selection_text.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class NearestReadings : public testing::Test {
 protected:
  NearestReadings() : vocabulary_(ade20k_labels()) {
    vocabulary_.prefer({ade20k_labels().find("bed"), ade20k_labels().find("lamp"), ade20k_labels().find("bench")});
  }
  std::vector<std::string> of(const std::string& text) const { return nearest_readings(text, vocabulary_); }
  Vocabulary vocabulary_;
};

TEST_F(NearestReadings, AMistypedNameIsReplaced) {
  const auto readings = of("delete bedd");
  EXPECT_THAT(readings, SizeIs(3));
  EXPECT_EQ(readings[0], "delete bed");
}

TEST_F(NearestReadings, AMistypedVerbIsReplaced) {
  const auto readings = of("delte bed");
  EXPECT_THAT(readings, SizeIs(3));
  EXPECT_EQ(readings[0], "delete bed");
}

TEST_F(NearestReadings, AMistypedUndoIsAnUndo) {
  EXPECT_THAT(of("undoo"), ElementsAre("undo"));
  EXPECT_THAT(of("udno the last two edits"), ElementsAre("undo the last two edits"));
}

TEST_F(NearestReadings, NumbersAndOtherNamesStay) {
  EXPECT_EQ(of("delete lampp#2")[0], "delete lamp#2");
  EXPECT_EQ(of("delete bed, lampp")[0], "delete bed, lamp");
}

TEST_F(NearestReadings, ANameAloneAsksForAnEdit) {
  EXPECT_THAT(of("bed"), ElementsAre("highlight bed", "delete bed", "extract bed"));
}

TEST_F(NearestReadings, EveryReadingIsUnderstood) {
  for (const char* text : {"dlete lamp", "delete chest of drawes", "remov the bigest lamp", "make the bed disappear"}) {
    for (const std::string& reading : of(text)) {
      EXPECT_NO_THROW(parse_selection(parse_edit(reading).select, vocabulary_)) << text << " -> " << reading;
    }
  }
}

TEST_F(NearestReadings, WhatIsUnderstoodHasNone) { EXPECT_THAT(of("delete bed"), IsEmpty()); }

TEST_F(NearestReadings, AMistypedSizeOrColourIsReplaced) {
  EXPECT_EQ(of("delete the bigest lamp").at(0), "delete the biggest lamp");
  EXPECT_EQ(of("highlight the smalest bench").at(0), "highlight the smallest bench");
  EXPECT_EQ(of("recolor bed drak green").at(0), "recolor bed dark green");
}

TEST_F(NearestReadings, AWordTooMuchIsLeftOut) {
  EXPECT_EQ(of("delete the rusty lamp")[0], "delete the lamp");
  EXPECT_EQ(of("highlight the ugly bench")[0], "highlight the bench");
  EXPECT_EQ(of("make the bed bigger").at(0), "highlight the bed");
}

TEST_F(NearestReadings, AnotherVerbAsksForWhatDoesNoHarmFirst) {
  EXPECT_THAT(of("vacuum the bed"), ElementsAre("highlight the bed", "delete the bed", "extract the bed"));
  EXPECT_EQ(of("change the bed").at(0), "highlight the bed");
  EXPECT_EQ(of("add a lamp next to the bed").at(0), "duplicate a lamp next to the bed");
  EXPECT_THAT(of("leave the bed"), ElementsAre("highlight the bed"));
}

TEST_F(NearestReadings, ANegationIsNeverAnEdit) {
  for (const char* text : {"please don't delete the bed", "never delete the bed", "Do not delete the bed",
                           "don\xe2\x80\x99t delete the bed"})
    EXPECT_THAT(of(text), ElementsAre("highlight the bed")) << text;
}

TEST_F(NearestReadings, ALighterThingIsRecolored) {
  EXPECT_THAT(of("make the bed lighter"), ElementsAre("recolor the bed light gray"));
  EXPECT_THAT(of("make the bed a bit darker"), ElementsAre("recolor the bed dim gray"));
}

TEST_F(NearestReadings, AnUnknownThingIsNotTheWholeRoom) { EXPECT_THAT(of("delete all appliances"), IsEmpty()); }

TEST_F(NearestReadings, AStretchOfSmallWordsIsNoName) {
  vocabulary_.prefer({ade20k_labels().find("book")});
  EXPECT_THAT(of("highlight the lamp nearest to me"), testing::Not(testing::Contains(testing::HasSubstr("tome"))));
}

TEST_F(NearestReadings, ASecondVerbIsASecondEdit) {
  try {
    read_request("delete the bed and keep the pillows", vocabulary_);
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_THAT(error.details().message, testing::HasSubstr("\"keep\" begins another one"));
  }
}

TEST_F(NearestReadings, AnUnclearUndoHasNone) { EXPECT_THAT(of("put the bed back"), IsEmpty()); }

TEST_F(NearestReadings, OnlyUnknownWordsGetReadings) {
  const Error unclear(
      {ErrorKind::kUsage, "\"largest pillows\" does not tell how many are meant", {}, {}, "say how many"});
  EXPECT_EQ(with_readings(unclear, "delete the largest pillows", vocabulary_).details().remedy, "say how many");
}

TEST_F(NearestReadings, TwoEditsInOneSentenceAreRefused) {
  try {
    read_request("delete bed; recolor the bench red", vocabulary_);
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_EQ(error.details().remedy, "make the edits one after the other");
  }
}

TEST_F(NearestReadings, LongTextsHaveNone) { EXPECT_THAT(of("delete " + std::string(3000, 'x')), IsEmpty()); }

}  // namespace
}  // namespace aligngs
