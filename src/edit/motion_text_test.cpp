#include "edit/motion_text.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/turn_text.h"

namespace aligngs {
namespace {

/// The rest of the text, and the shift.
std::pair<std::string, std::string> taken(std::string text) {
  const auto motion = take_motion(text);
  return {text, motion ? motion_text(*motion) : "none"};
}

TEST(MotionText, ThreeNumbers) {
  EXPECT_EQ(taken("sofa, chair by 0.5,0,-0.2"), std::pair(std::string("sofa, chair"), std::string(" by 0.5,0,-0.2")));
  EXPECT_EQ(taken("sofa by 0.5, 0, -0.2 and turn by 90").second, " by 0.5,0,-0.2 and turn by 90");
}

TEST(MotionText, ACommaMayBeADecimalPoint) {
  EXPECT_EQ(taken("sofa by 0,5 0 -0,2").second, " by 0.5,0,-0.2");
  EXPECT_EQ(taken("sofa by 0,5; 0; -0,2 and turn by 22,5").second, " by 0.5,0,-0.2 and turn by 22.5");
  EXPECT_EQ(parse_shift("0,5;0;-0,2").x, 0.5);
  EXPECT_EQ(parse_turn("22,5"), 22.5);
  std::string text = "armchair 22,5 degrees";
  EXPECT_EQ(take_turn(text), 22.5);
}

TEST(MotionText, ALengthAndADirection) {
  EXPECT_EQ(taken("chair#2 0.5 m to the left"), std::pair(std::string("chair#2"), std::string(" by -0.5,0,0")));
  EXPECT_EQ(taken("lamp by 0.2 up"), std::pair(std::string("lamp"), std::string(" by 0,0.2,0")));
  EXPECT_EQ(taken("the largest rug 1 metre away").second, " by 0,0,-1");
}

TEST(MotionText, LengthsHaveTheUnitsOfPeople) {
  for (const auto& [text, motion] :
       std::vector<std::pair<const char*, const char*>>{{"bed 50cm to the left", " by -0.5,0,0"},
                                                        {"bed 50 centimetres up", " by 0,0.5,0"},
                                                        {"bed by 1,5 m to the right", " by 1.5,0,0"},
                                                        {"bed -50 cm to the left", " by 0.5,0,0"},
                                                        {"bed 10 inches down", " by 0,-0.254,0"},
                                                        {"bed 2 feet towards me", " by 0,0,0.6096"},
                                                        {"bed up 20 cm", " by 0,0.2,0"},
                                                        {"bed to the left by 0.5", " by -0.5,0,0"},
                                                        {"bed backwards 500 mm", " by 0,0,-0.5"},
                                                        {"bed 2 upwards", " by 0,2,0"},
                                                        {"bed 20cm higher", " by 0,0.2,0"},
                                                        {"bed 1 meter towards the camera", " by 0,0,1"},
                                                        {"bed 1 m left and 0.5 m back", " by -1,0,-0.5"}}) {
    EXPECT_EQ(taken(text), std::pair(std::string("bed"), std::string(motion))) << text;
  }
  for (const char* text : {"bed 50cm", "bed by 2 m", "bed 2000 m to the left"}) {
    std::string taken_from = text;
    EXPECT_THROW(take_motion(taken_from), Error) << text;
  }
}

TEST(MotionText, ALengthTowardAThing) {
  for (const char* text :
       {"chair 50 cm towards the window", "chair by 0.5 m toward window", "chair 0.5m closer to the window",
        "chair towards the window by 50 cm", "chair nearer to the window by 0.5 m"}) {
    std::string rest = text;
    const auto motion = take_motion(rest);
    ASSERT_TRUE(motion) << text;
    EXPECT_EQ(rest, "chair") << text;
    EXPECT_EQ(motion->toward, "window") << text;
    EXPECT_EQ(motion->distance, 0.5) << text;
    EXPECT_TRUE(motion->in_metres) << text;
  }
  std::string away = "chair 1 away from the bed";
  EXPECT_EQ(take_motion(away)->distance, -1);
}

TEST(MotionText, OnlyAUnitMakesMetres) {
  std::string metres = "chair 0.5 m to the left", units = "chair 0.5 to the left", numbers = "chair by 0.5,0,0";
  EXPECT_TRUE(take_motion(metres)->in_metres);
  EXPECT_FALSE(take_motion(units)->in_metres);
  EXPECT_FALSE(take_motion(numbers)->in_metres);
}

TEST(MotionText, AThingWithoutALengthIsRefused) {
  for (const char* text : {"chair to the window", "chair towards the window", "chair next to the window"}) {
    try {
      refuse_place(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.details().remedy, testing::HasSubstr("0.5 m towards the window")) << text;
    }
  }
  EXPECT_NO_THROW(refuse_place("chair"));
}

/// Message and remedy of a text that is refused.
template <class Reader>
std::string refused_motion(const Reader& read, std::string text) {
  try {
    read(text);
    ADD_FAILURE() << text;
  } catch (const Error& error) {
    return error.details().message + " | " + error.details().remedy;
  }
  return "";
}

TEST(MotionText, ThreeDigitsAfterAMarkHaveTwoReadings) {
  for (const char* text : {"armchair 1,500 mm to the right", "armchair to the right by 1.500 mm",
                           "armchair 1,500 mm towards the window"}) {
    EXPECT_THAT(refused_motion(take_motion, text),
                testing::AllOf(testing::HasSubstr("two readings"), testing::HasSubstr("\"1.5 mm\" or \"1500 mm\"")))
        << text;
  }
  EXPECT_THAT(refused_motion(take_motion, "armchair 1.000 mm left"), testing::HasSubstr("\"1 mm\" or \"1000 mm\""));
}

TEST(MotionText, DecimalsThatAreClearStay) {
  EXPECT_EQ(taken("bed 0,500 m to the left").second, " by -0.5,0,0");
  EXPECT_EQ(taken("bed 0.125 m to the left").second, " by -0.125,0,0");
  EXPECT_EQ(taken("bed 1.250 m to the left").second, " by -1.25,0,0") << "no room has 1250 m";
  EXPECT_EQ(taken("bed 1.25 cm to the left").second, " by -0.0125,0,0");
}

TEST(MotionText, LengthsInWordsAndMarks) {
  EXPECT_EQ(taken("bed 5' left").second, " by -1.524,0,0");
  EXPECT_EQ(taken("bed 10\" up").second, " by 0,0.254,0");
  EXPECT_EQ(taken("bed two hundred cm right").second, " by 2,0,0");
  EXPECT_EQ(taken("bed 1/2 m right").second, " by 0.5,0,0");
}

TEST(MotionText, ALengthKeepsItsPlaceInTheReading) {
  EXPECT_THAT(refused_motion(refuse_place, "the armchair 20 cm against the wall"),
              testing::HasSubstr("\"move the armchair 20 cm towards the wall\""));
}

TEST(MotionText, NorthIsNoDirection) {
  for (const char* text : {"armchair 20 cm north", "armchair 20 cm to the north"})
    EXPECT_THAT(refused_motion(refuse_place, text),
                testing::AllOf(testing::HasSubstr("is no direction"), testing::HasSubstr("say left, right")))
        << text;
}

TEST(MotionText, ACopyToASideAsksForALength) {
  EXPECT_THAT(refused_motion(refuse_side, "the armchair to the left"),
              testing::AllOf(testing::HasSubstr("\"copy the armchair 0.5 m to the left\""),
                             testing::HasSubstr("\"copy the left armchair\"")));
  EXPECT_NO_THROW(refuse_side("the armchair on the left"));
}

TEST(MotionText, TurnsHaveShortWordsAndSidesFirst) {
  for (const auto& [text, degrees] :
       std::vector<std::pair<const char*, double>>{{"chair 90\xc2\xb0 cw", -90},
                                                   {"chair 90 ccw", 90},
                                                   {"chair anticlockwise by 30 degrees", 30},
                                                   {"chair three quarters of a turn", 270},
                                                   {"chair 1/4 turn clockwise", -90}}) {
    std::string rest = text;
    EXPECT_EQ(take_turn(rest), degrees) << text;
    EXPECT_EQ(rest, "chair") << text;
  }
}

TEST(MotionText, TheSideOfAnObjectIsNoTurn) {
  std::string text = "the lamp on the left 30";
  EXPECT_EQ(take_turn(text), 30);
  EXPECT_EQ(text, "the lamp on the left");
}

TEST(MotionText, PartsOfATurn) {
  for (const auto& [text, degrees] :
       std::vector<std::pair<const char*, double>>{{"chair a quarter turn", 90},
                                                   {"chair by a quarter turn to the right", -90},
                                                   {"chair half a turn", 180},
                                                   {"chair a quarter of a turn", 90},
                                                   {"chair by a quarter turn clockwise", -90}}) {
    std::string rest = text;
    EXPECT_EQ(take_turn(rest), degrees) << text;
    EXPECT_EQ(rest, "chair") << text;
  }
}

TEST(MotionText, APlusSignIsPartOfANumber) {
  EXPECT_EQ(parse_turn("+90"), 90);
  EXPECT_EQ(parse_shift("+0.1,0,-0.5").x, 0.1);
  EXPECT_EQ(taken("sofa +0.5 m to the left").second, " by -0.5,0,0");
  std::string text = "sofa by +90 degrees";
  EXPECT_EQ(take_turn(text), 90);
  EXPECT_THROW(parse_turn("+-90"), Error);
}

TEST(MotionText, ALengthThatIsTooLongIsNamed) {
  for (std::string text : {"sofa 1e30 m left", "sofa 1e30 m towards the bed", "sofa left by 1e30 m"}) {
    try {
      take_motion(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("\"1e30\" is no length of at most 1000")) << text;
    }
  }
  EXPECT_EQ(taken("sofa 5e-1 m left").second, " by -0.5,0,0");
}

TEST(MotionText, AMotionOfNothingIsRefused) {
  for (const double turn : {0.0, 360.0, -360.0}) {
    ObjectMotion still;
    still.turn = turn;
    EXPECT_THROW(require_motion(still), Error) << turn;
  }
  ObjectMotion turned, moved;
  turned.turn = 359;
  moved.shift.x = 0.001;
  EXPECT_NO_THROW(require_motion(turned));
  EXPECT_NO_THROW(require_motion(moved));
}

TEST(MotionText, OtherTextsHaveNone) {
  for (const char* text : {"sofa", "sofa by", "sofa by 1,2", "sofa left", "by 1,2,3"})
    EXPECT_EQ(taken(text).second, "none") << text;
}

TEST(MotionText, TheRemedyTellsTheLargestShift) {
  try {
    parse_shift("1e9,0,0");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.details().remedy, testing::HasSubstr("at most 1000"));
  }
}

TEST(MotionText, NumbersAreBounded) {
  for (const char* text : {"1,2", "1,2,3,4", "a,b,c", "1e9,0,0", "nan,0,0", ""})
    EXPECT_THROW(parse_shift(text), Error) << text;
  for (const char* text : {"", "x", "361", "inf"}) EXPECT_THROW(parse_turn(text), Error) << text;
}

TEST(MotionText, ATurnIsCounterClockwise) {
  std::string text = "armchair by 45 degrees";
  EXPECT_EQ(take_turn(text), 45.0);
  EXPECT_EQ(text, "armchair");
  text = "armchair 30\xc2\xb0";
  EXPECT_EQ(take_turn(text), 30.0);
  text = "armchair 30 clockwise";
  EXPECT_EQ(take_turn(text), -30.0);
}

}  // namespace
}  // namespace aligngs
