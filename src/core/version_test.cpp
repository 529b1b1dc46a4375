#include "core/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(Version, HasThreeNumbers) { EXPECT_THAT(version(), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+")); }

}  // namespace
}  // namespace aligngs
