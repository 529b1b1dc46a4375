#include "core/shell_word.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(ShellWord, OnlyWordsThatAShellWouldChangeAreQuoted) {
  EXPECT_EQ(quote_word("out/run-1"), "out/run-1");
  EXPECT_EQ(quote_word(""), "''");
  EXPECT_EQ(quote_word("my photos"), "'my photos'");
  EXPECT_EQ(quote_word("it's"), "'it'\\''s'");
  EXPECT_EQ(quote_word("a\nb"), "'a\nb'");
  EXPECT_EQ(join_words({"run", "a b"}), "run 'a b'");
}

}  // namespace
}  // namespace aligngs
