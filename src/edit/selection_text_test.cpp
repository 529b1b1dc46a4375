#include "edit/selection_text.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

std::string canonical(const std::string& text) {
  const Vocabulary vocabulary(ade20k_labels());
  return selection_text(parse_selection(text, vocabulary), ade20k_labels());
}

std::string refusal(const std::string& text) {
  try {
    canonical(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << text;
  return "";
}

TEST(SelectionText, AListIsAUnion) {
  EXPECT_EQ(canonical("pillow, cushion"), "cushion, pillow");
  EXPECT_EQ(canonical("Pillows and cushions"), "cushion, pillow");
  EXPECT_EQ(canonical("pillow,pillow , PILLOW"), "pillow");
}

TEST(SelectionText, ObjectsHaveNumbers) {
  EXPECT_EQ(canonical("pillow#2, pillow #1, couch#3"), "sofa#3, pillow#1, pillow#2");
  for (const char* bad : {"pillow#", "pillow#0", "pillow#-1", "pillow#x", "pillow#1x", "pillow#99999999999"}) {
    EXPECT_THAT(refusal(bad), HasSubstr("object number")) << bad;
  }
}

TEST(SelectionText, NumbersThatAreWrongAreToldApart) {
  EXPECT_THAT(refusal("cushion#3-1"), HasSubstr("counts backwards"));
  EXPECT_THAT(refusal("bed#1 bed#1"), HasSubstr("goes on after the object number"));
  EXPECT_THAT(refusal("pillow#1-5000"), HasSubstr("more than 1000 objects"));
}

TEST(SelectionText, PeopleSayAllAndEvery) {
  EXPECT_EQ(canonical("all beds"), "bed");
  EXPECT_EQ(canonical("all of the lamps, each pillow"), "lamp, pillow");
  EXPECT_EQ(canonical("every lamp but lamp#2"), "lamp but lamp#2");
  EXPECT_EQ(canonical("every lamp but not lamp#2"), "lamp but lamp#2");
  EXPECT_EQ(canonical("all but the walls"), "everything but wall");
}

TEST(SelectionText, PeopleJoinAndExcludeInManyWords) {
  for (const char* text :
       {"bed & lamp", "bed + lamp", "bed or lamp", "bed as well as the lamp", "bed; lamp", "bed, and lamp"})
    EXPECT_EQ(canonical(text), "bed, lamp") << text;
  EXPECT_EQ(canonical("bed, lamp, and pillow"), "bed, lamp, pillow");
  for (const char* text : {"lamps, except lamp#2", "lamps except for lamp#2", "lamps other than lamp#2",
                           "lamps apart from lamp#2", "lamps save for lamp#2", "lamps minus lamp#2"})
    EXPECT_EQ(canonical(text), "lamp but lamp#2") << text;
  EXPECT_EQ(canonical("my bed and those lamps"), "bed, lamp");
  for (const char* bad : {"and", "bed and", "or lamp", "bed, and", "lamps except", "except lamps"}) refusal(bad);
}

TEST(SelectionText, PeopleCountInWords) {
  for (const char* text : {"the second pillow", "2nd pillow", "pillow two", "pillow no. 2", "pillow number 2"})
    EXPECT_EQ(canonical(text), "pillow#2") << text;
  EXPECT_EQ(canonical("pillows 1 and 2"), "pillow#1, pillow#2");
  EXPECT_EQ(canonical("pillows#1,3"), "pillow#1, pillow#3");
  EXPECT_EQ(canonical("pillows 1 to 3"), "pillow#1-3");
  EXPECT_EQ(canonical("the 11th pillow"), "pillow#11");
  for (const char* bad : {"the 0th pillow", "pillow, 2", "pillow zero", "second"}) refusal(bad);
}

TEST(SelectionText, ARangeIsManyNumbers) {
  EXPECT_EQ(canonical("bed#1-3"), "bed#1-3");
  EXPECT_EQ(canonical("bed #1 to #3"), "bed#1-3");
  EXPECT_EQ(canonical("bed#1-2"), "bed#1, bed#2");
  EXPECT_EQ(canonical("bed#1, #2, #4"), "bed#1, bed#2, bed#4");
  EXPECT_EQ(canonical("pillow 2"), "pillow#2");
  for (const char* bad : {"bed#3-1", "bed#0-2", "bed#1-", "bed#1-9999", "#1"}) refusal(bad);
}

TEST(SelectionText, OneObjectByItsLook) {
  EXPECT_EQ(canonical("the largest chair"), "largest chair");
  EXPECT_EQ(canonical("the big chair, the smaller lamp"), "largest chair, smallest lamp");
  EXPECT_EQ(canonical("the pillow on the left, chair on the RIGHT"), "right chair, left pillow");
  EXPECT_EQ(canonical("Leftmost pillow and the biggest rug"), "largest rug, left pillow");
  EXPECT_THAT(refusal("the largest chair#2"), HasSubstr("object number"));
}

TEST(SelectionText, EverythingButSomething) {
  EXPECT_EQ(canonical("everything but wall, floor"), "everything but wall, floor");
  EXPECT_EQ(canonical("ALL except the walls"), "everything but wall");
}

TEST(SelectionText, ExclusionsApplyToLists) {
  EXPECT_EQ(canonical("pillow, sofa without pillow#2"), "sofa, pillow but pillow#2");
}

TEST(SelectionText, TheCanonicalTextReadsBack) {
  for (const char* text : {"everything but wall, floor", "pillow#2 and sofa", "chests of drawers, rug except rug#1"}) {
    EXPECT_EQ(canonical(canonical(text)), canonical(text));
  }
}

TEST(SelectionText, ExceptionsNeedNoName) {
  const Vocabulary vocabulary(ade20k_labels());
  const auto text_of = [&](const char* text) {
    return selection_text(parse_selection(text, vocabulary), ade20k_labels());
  };
  EXPECT_EQ(text_of("every lamp but the left one"), "lamp but left lamp");
  EXPECT_EQ(text_of("all pillows except the largest"), "pillow but largest pillow");
  EXPECT_EQ(text_of("all chairs but the ones on the rug"), text_of("all chairs but the chairs on the rug"));
}

TEST(SelectionText, QuotesAndACommaAtTheEndSayNothing) {
  const Vocabulary vocabulary(ade20k_labels());
  const auto text_of = [&](const char* text) {
    return selection_text(parse_selection(text, vocabulary), ade20k_labels());
  };
  EXPECT_EQ(text_of("\"bed\""), "bed");
  EXPECT_EQ(text_of("'bed', 'lamp'"), text_of("bed, lamp"));
  EXPECT_EQ(text_of("bed, lamp,"), text_of("bed, lamp"));
}

TEST(SelectionText, MistakesAreUsageErrorsThatHelp) {
  EXPECT_THAT(refusal("pilow"), HasSubstr("did you mean \"pillow\""));
  EXPECT_THAT(refusal(""), HasSubstr("nothing is selected"));
  EXPECT_THAT(refusal("pillow,,cushion"), HasSubstr("empty item"));
  EXPECT_THAT(refusal("everything but"), HasSubstr("empty item"));
  EXPECT_THAT(refusal("everything but everything"), HasSubstr("everything"));
  EXPECT_THAT(refusal(std::string("pil\0low", 7)), HasSubstr("zero byte"));
  EXPECT_THAT(refusal(std::string(100000, ',')), HasSubstr("longer"));
}

TEST(SelectionText, AClassWhoseNameHoldsAndIsOneItem) {
  LabelSet labels;
  labels.classes = {{"washer and dryer", {}, {}}, {"rug", {}, {}}};
  const SelectionQuery query = parse_selection("washer and dryer, rug", Vocabulary(labels));
  EXPECT_EQ(query.include.size(), 2u);
}

TEST(Threshold, ArgmaxAutoOrAProbability) {
  EXPECT_EQ(parse_threshold("argmax").kind, ThresholdRule::Kind::kArgmax);
  EXPECT_EQ(parse_threshold("Auto").kind, ThresholdRule::Kind::kAuto);
  EXPECT_DOUBLE_EQ(parse_threshold("0.25").value, 0.25);
  for (const char* text : {"argmax", "auto", "0.25"}) EXPECT_EQ(threshold_text(parse_threshold(text)), text);
  for (const char* bad : {"", "0", "1.5", "-1", "nan", "inf", "0.5x", "much"}) {
    EXPECT_THROW(parse_threshold(bad), Error) << bad;
  }
}

}  // namespace
}  // namespace aligngs
