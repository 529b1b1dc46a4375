#include "edit/color_names.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/edit_operation.h"

namespace aligngs {
namespace {

std::string hex(std::string_view text) {
  const auto color = named_color(text);
  return color ? color_text(*color) : "";
}

TEST(ColorNames, NamesOfCssInAnySpelling) {
  EXPECT_EQ(hex("dark green"), "#006400");
  EXPECT_EQ(hex("DarkGreen"), "#006400");
  EXPECT_EQ(hex("light-blue"), "#add8e6");
  EXPECT_EQ(hex("dark slate grey"), "#2f4f4f");
}

TEST(ColorNames, AShadeOfANameThatHasNoNameOfItsOwn) {
  EXPECT_EQ(hex("dark brown"), "#5b1717");
  EXPECT_EQ(hex("pale terracotta"), "#f5cec6");
}

TEST(ColorNames, AHueAfterANameSaysNothingNew) {
  EXPECT_EQ(hex("navy blue"), hex("navy"));
  EXPECT_EQ(hex("olive green"), hex("olive"));
  EXPECT_EQ(hex("emerald-green"), hex("emerald"));
  EXPECT_EQ(hex("red blue"), "") << "two hues";
}

TEST(ColorNames, OtherWordsAreNoColours) {
  for (const char* text : {"", "dark", "sofa", "greenish", "#00ff00"}) EXPECT_EQ(hex(text), "") << text;
}

TEST(ColorNames, AColourIsReadAsHexOrAsAName) {
  EXPECT_EQ(color_text(read_color("#ADD8E6")), "#add8e6");
  EXPECT_EQ(color_text(read_color("sky blue")), "#87ceeb");
  EXPECT_THROW(read_color("bleu"), Error);
  EXPECT_THROW(read_color("#12345"), Error);
}

TEST(ColorNames, ANameThatIsNoneIsAnsweredWithTheNearest) {
  for (const auto& [text, near] :
       {std::pair("reddish", "\"red\""), {"bleu", "\"blue\""}, {"turqoise", "\"turquoise\""}}) {
    try {
      read_color(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(error.details().remedy.find(near), std::string::npos) << error.details().remedy;
    }
  }
}

TEST(ColorNames, TheLongestNameIsTakenOffTheEnd) {
  const auto rest_of = [](std::string text) {
    EXPECT_TRUE(take_color(text)) << text;
    return text;
  };
  EXPECT_EQ(rest_of("sofa dark green"), "sofa");
  EXPECT_EQ(rest_of("coffee table to green"), "coffee table");
  EXPECT_EQ(rest_of("chest of drawers in light sky blue"), "chest of drawers");
  EXPECT_EQ(rest_of("sofa#1 #fa0"), "sofa#1");
  EXPECT_EQ(rest_of("the armchair navy blue"), "the armchair");
  EXPECT_EQ(rest_of("sand red"), "sand") << "an object is left";
  EXPECT_EQ(rest_of("blue"), "");
}

TEST(ColorNames, AnObjectNumberIsNoColour) {
  std::string text = "pillow #1";
  EXPECT_FALSE(take_color(text));
  EXPECT_EQ(text, "pillow #1");
}

}  // namespace
}  // namespace aligngs
