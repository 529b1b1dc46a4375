#include "batch/option_words.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(OptionWords, BlanksSeparateAndQuotesKeep) {
  EXPECT_THAT(split_words("--method colmap  -n 200"), ElementsAre("--method", "colmap", "-n", "200"));
  EXPECT_THAT(split_words("--config 'my settings.toml' \"a b\" c\\ d"),
              ElementsAre("--config", "my settings.toml", "a b", "c d"));
  EXPECT_THAT(split_words("''"), ElementsAre(""));
  EXPECT_THAT(split_words(" \t"), IsEmpty());
}

TEST(OptionWords, NothingIsExpanded) {
  EXPECT_THAT(split_words("$HOME *.png `date`"), ElementsAre("$HOME", "*.png", "`date`"));
}

TEST(OptionWords, AnOpenQuoteIsAnError) {
  EXPECT_THROW(split_words("--config 'my settings.toml"), Error);
  EXPECT_THROW(split_words("\"a"), Error);
}

TEST(OptionWords, QuotedWordsReadBack) {
  const std::vector<std::string> words = {"plain", "two words", "it's", "", "$x", "a\"b", "--set", "a=[1, 2]"};
  EXPECT_EQ(split_words(join_words(words)), words);
}

TEST(OptionWords, OptionsAreFoundInBothSpellings) {
  const std::vector<std::string> words = {"--memory", "2", "--size=64x48", "--memory=3"};
  EXPECT_TRUE(has_option(words, "--size"));
  EXPECT_FALSE(has_option(words, "--siz"));
  EXPECT_EQ(option_value(words, "--size"), "64x48");
  EXPECT_EQ(option_value(words, "--memory"), "3");
  EXPECT_EQ(option_value(words, "--views"), "");
}

}  // namespace
}  // namespace aligngs
