#include "refine/push_pull.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(SpreadColor, OneKnownPixelColoursTheWholeMap) {
  ImageF color(7, 5, 3), weight(7, 5, 1);
  const float known[3] = {0.2f, 0.5f, 0.9f};
  for (int c = 0; c < 3; ++c) color.at(2, 3, c) = known[c];
  weight.at(2, 3) = 1;
  const ImageF out = push_pull(color, weight);
  for (size_t i = 0; i < out.data.size(); ++i) EXPECT_NEAR(out.data[i], known[i % 3], 1e-5f);
}

TEST(SpreadColor, KnownPixelsKeepTheirColourAndGapsLieBetweenThem) {
  ImageF color(32, 8, 3), weight(32, 8, 1);
  for (int y = 0; y < 8; ++y) {
    weight.at(0, y) = weight.at(31, y) = 1;
    for (int c = 0; c < 3; ++c) color.at(31, y, c) = 1;
  }
  const ImageF out = push_pull(color, weight);
  for (int y = 0; y < 8; ++y) {
    EXPECT_EQ(out.at(0, y), 0.0f);
    EXPECT_EQ(out.at(31, y), 1.0f);
    EXPECT_LT(out.at(4, y), out.at(16, y));
    EXPECT_LT(out.at(16, y), out.at(27, y));
  }
}

TEST(SpreadColor, WhatUnknownPixelsHoldDoesNotCount) {
  ImageF color(4, 4, 3, 7.0f), weight(4, 4, 1);
  for (int c = 0; c < 3; ++c) color.at(1, 1, c) = 0.25f;
  weight.at(1, 1) = 1;
  const ImageF out = push_pull(color, weight);
  for (const float value : out.data) EXPECT_NEAR(value, 0.25f, 1e-6f);
}

TEST(SpreadColor, KnownNowhereIsBlackAndNoMapIsNone) {
  const ImageF out = push_pull(ImageF(3, 2, 3, 0.5f), ImageF(3, 2, 1));
  for (const float value : out.data) EXPECT_EQ(value, 0.0f);
  EXPECT_TRUE(push_pull({}, {}).empty());
}

}  // namespace
}  // namespace aligngs
