#include "cli/help_text.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(WordsInHelp, SizesOfOneNetworkAreOneEntry) {
  EXPECT_EQ(words_in_help({"vggt", "dpt-g", "linear-g", "dpt-l", "linear-l"}), "vggt, dpt-g|l, linear-g|l");
}

TEST(WordsInHelp, AWordWithoutASizeStandsAlone) {
  EXPECT_EQ(words_in_help({"vggt", "vggt-commercial"}), "vggt, vggt-commercial");
}

}  // namespace
}  // namespace aligngs
