#include "edit/relation/color_words.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(ColorWords, GrayHasNoChroma) {
  const SeenColor gray = seen_color(0.5, 0.5, 0.5);
  EXPECT_NEAR(gray.lightness, 53.4, 0.1);  // L* of sRGB 0.5
  EXPECT_NEAR(gray.chroma, 0, 0.1);
}

TEST(ColorWords, DullColoursOfPhotosHaveTheirWord) {
  EXPECT_EQ(plain_color_word(seen_color(0.45, 0.3, 0.18)), "brown");
  EXPECT_EQ(plain_color_word(seen_color(0.25, 0.35, 0.5)), "blue");
  EXPECT_EQ(plain_color_word(seen_color(0.3, 0.42, 0.25)), "green");
  EXPECT_EQ(plain_color_word(seen_color(0.85, 0.8, 0.7)), "beige");
}

TEST(ColorWords, ABorderIsNearly) {
  EXPECT_EQ(color_fit("white", seen_color(0.95, 0.95, 0.95)), ColorFit::kYes);
  EXPECT_EQ(color_fit("white", seen_color(0.72, 0.72, 0.72)), ColorFit::kNearly);
  EXPECT_EQ(color_fit("white", seen_color(0.3, 0.3, 0.3)), ColorFit::kNo);
}

TEST(ColorWords, ShadesCount) {
  const SeenColor dark = seen_color(0.05, 0.2, 0.08);
  EXPECT_EQ(color_fit("dark green", dark), ColorFit::kYes);
  EXPECT_EQ(color_fit("light green", dark), ColorFit::kNo);
}

TEST(ColorWords, DullBeigeIsNoLightGreen) {
  EXPECT_EQ(color_fit("light green", seen_color(0.6, 0.58, 0.51)), ColorFit::kNo);
}

TEST(ColorWords, DullGreenIsLightGreen) {
  EXPECT_EQ(color_fit("light green", seen_color(0.6, 0.65, 0.55)), ColorFit::kYes);
}

TEST(ColorWords, NamesOfTablesCount) { EXPECT_EQ(color_fit("navy", seen_color(0.05, 0.05, 0.45)), ColorFit::kYes); }

TEST(ColorWords, AColourIsTakenOffTheBegin) {
  std::string_view item = "the Dark-Green chair";
  EXPECT_EQ(take_color_word(item), "dark green");
  EXPECT_EQ(item, "chair");
}

TEST(ColorWords, OtherWordsStay) {
  std::string_view item = "the chair";
  EXPECT_EQ(take_color_word(item), "");
  EXPECT_EQ(item, "the chair");
}

}  // namespace
}  // namespace aligngs
