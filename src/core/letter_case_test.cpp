#include "core/letter_case.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(LetterCase, AsciiLettersLoseTheirCaseAndOtherBytesStay) {
  EXPECT_EQ(lower_case("IMG_01.JPEG @[`{ \xc3\x84\xff"), "img_01.jpeg @[`{ \xc3\x84\xff");
}

}  // namespace
}  // namespace aligngs
