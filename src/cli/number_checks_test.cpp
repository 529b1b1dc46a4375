#include "cli/number_checks.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

/// Empty: accepted.
std::string refusal_of_seed(std::string text) { return seed_number()(text); }

TEST(SeedNumber, WholeNumbersOfAJsonFilePass) {
  for (const char* seed : {"0", "7", "9007199254740992"}) EXPECT_EQ(refusal_of_seed(seed), "") << seed;
}

TEST(SeedNumber, OthersAreRefused) {
  for (const char* seed : {"-1", "1.5", "1e23", "9007199254740993", "18446744073709551615", "x", ""})
    EXPECT_NE(refusal_of_seed(seed), "") << seed;
}

}  // namespace
}  // namespace aligngs
