#include "edit/length_words.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(LengthWords, FeetAndInches) {
  EXPECT_EQ(with_plain_lengths("armchair 5' left"), "armchair 5 ft left");
  EXPECT_EQ(with_plain_lengths("armchair 12\" right"), "armchair 12 in right");
  EXPECT_EQ(with_plain_lengths("armchair 5'6\" right"), "armchair 66 in right");
}

TEST(LengthWords, QuotesAroundANameStay) {
  EXPECT_EQ(with_plain_lengths("\"lamp 2\" 20 cm left"), "\"lamp 2\" 20 cm left");
}

TEST(LengthWords, Fractions) {
  EXPECT_EQ(with_plain_lengths("chair 1/2 m left"), "chair 0.5 m left");
  EXPECT_EQ(with_plain_lengths("chair \xc2\xbd m left"), "chair 0.5 m left");
  EXPECT_EQ(with_plain_lengths("chair 1 1/4 m left"), "chair 1.25 m left");
  EXPECT_EQ(with_plain_lengths("chair 2\xc2\xbe inches left"), "chair 2.75 inches left");
}

TEST(LengthWords, NumbersInWords) {
  EXPECT_EQ(with_plain_lengths("chair two hundred cm right"), "chair 200 cm right");
  EXPECT_EQ(with_plain_lengths("chair by a hundred and twenty-five cm right"), "chair by 125 cm right");
  EXPECT_EQ(with_plain_lengths("chair Thirty centimetres up"), "chair 30 centimetres up");
  EXPECT_EQ(with_plain_lengths("chair two feet left"), "chair 2 feet left");
}

TEST(LengthWords, AndAHalf) {
  EXPECT_EQ(with_plain_lengths("chair one and a half metres left"), "chair 1.5 metres left");
  EXPECT_EQ(with_plain_lengths("chair 1 metre and a half left"), "chair 1.5 metre left");
}

TEST(LengthWords, OtherNumbersStay) {
  for (const char* text : {"pillow two 20 cm left", "the two in the corner", "both lamps", "chair by 0.5,0,-0.2"})
    EXPECT_EQ(with_plain_lengths(text), text);
}

}  // namespace
}  // namespace aligngs
