#include "serve/event_lines.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(EventLines, BecomeAnArray) {
  EXPECT_EQ(event_array("{\"step\":1}\n{\"step\":2}\r\n"), "[{\"step\":1},{\"step\":2}]");
}

TEST(EventLines, ATornLineLosesThatLineAlone) {
  EXPECT_EQ(event_array("{\"step\":1}\n{\"st{\"step\":2}\n{\"step\":3}\n"), "[{\"step\":1},{\"step\":3}]");
}

TEST(EventLines, WhatIsNoObjectIsLeftOut) {
  EXPECT_EQ(event_array("7\n[]\n\nnull\n" + std::string(1000, '{') + "\n"), "[]");
  EXPECT_EQ(event_array(""), "[]");
}

}  // namespace
}  // namespace aligngs
