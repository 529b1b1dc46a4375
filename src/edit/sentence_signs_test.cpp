#include "edit/sentence_signs.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(SentenceSigns, NegationsAreFound) {
  for (const char* text :
       {"don't delete the bed", "never delete the bed", "do not delete the bed", "delete not the bed"})
    EXPECT_TRUE(has_negation(text)) << text;
  EXPECT_FALSE(has_negation("delete the knot"));
}

TEST(SentenceSigns, TheSentenceBehindANegation) {
  EXPECT_EQ(behind_negation("do not delete the bed"), "delete the bed");
  EXPECT_EQ(behind_negation("delete the bed"), "delete the bed");
}

TEST(SentenceSigns, TheVerbOfASecondEdit) {
  EXPECT_EQ(second_verb("delete the bed and keep the pillows"), "keep");
  EXPECT_EQ(second_verb("delete the bed, then paint the sofa red"), "paint");
  EXPECT_FALSE(second_verb("delete the bed and the pillows"));
  EXPECT_FALSE(second_verb("move chair by 1,0,0 and turn by 90"));
}

}  // namespace
}  // namespace aligngs
