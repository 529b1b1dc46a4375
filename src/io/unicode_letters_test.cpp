#include "io/unicode_letters.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(CommonSpelling, ComposedAndDecomposedLettersAreOne) {
  EXPECT_EQ(common_spelling("K\u00fcche"), "ku\u0308che");
  EXPECT_EQ(common_spelling("Ku\u0308che"), "ku\u0308che");
  EXPECT_EQ(common_spelling("ph\u00f2ng b\u1ebfp"), "pho\u0300ng be\u0302\u0301p");
  EXPECT_EQ(common_spelling("\u0439"), "\u0438\u0306");
  EXPECT_EQ(common_spelling("\u30d1"), "\u30cf\u309a");
}

TEST(CommonSpelling, HangulSyllablesFallIntoTheirParts) {
  EXPECT_EQ(common_spelling("\uac00"), "\u1100\u1161");
  EXPECT_EQ(common_spelling("\ud55c"), "\u1112\u1161\u11ab");
}

TEST(CommonSpelling, OtherLettersStay) {
  EXPECT_NE(common_spelling("Kuche"), common_spelling("K\u00fcche"));
  EXPECT_EQ(common_spelling("IMG_1.JPG"), "img_1.jpg");
  EXPECT_EQ(common_spelling("K\xfc"), "ku\u0308") << "latin-1";
  EXPECT_EQ(common_spelling("\U0001f600"), "\U0001f600");
}

}  // namespace
}  // namespace aligngs
