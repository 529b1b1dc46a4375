#include "refine/label_paths.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace aligngs {
namespace {

/// A photo of two halves, of which the left one is dark; two labels.
struct Halves {
  static constexpr int kWidth = 20, kHeight = 10;
  ImageF costs{kWidth, kHeight, 2}, luma{kWidth, kHeight, 1, 0.2f};

  Halves() {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = kWidth / 2; x < kWidth; ++x) luma.at(x, y) = 0.8f;
    }
  }
};

TEST(LabelPaths, WhatIsKnownSpreadsToTheEdgeOfThePhoto) {
  Halves halves;
  for (int y = 0; y < Halves::kHeight; ++y) {
    halves.costs.at(0, y, 0) = 1;                     // the left border is of label 1
    halves.costs.at(Halves::kWidth - 1, y, 1) = 0.5;  // the right one of label 0
  }
  const Image<uint8_t> labels = label_by_paths(halves.costs, halves.luma, {}, {});
  for (int y = 0; y < Halves::kHeight; ++y) {
    for (int x = 0; x < Halves::kWidth; ++x)
      EXPECT_EQ(labels.at(x, y), x < Halves::kWidth / 2 ? 1 : 0) << x << " " << y;
  }
}

TEST(LabelPaths, APixelThatDiffersAloneIsNoise) {
  Halves halves;
  for (float& cost : halves.costs.data) cost = 0.1f;
  for (int y = 0; y < Halves::kHeight; ++y) {
    for (int x = 0; x < Halves::kWidth; ++x) halves.costs.at(x, y, 0) = 0;
  }
  halves.costs.at(5, 5, 0) = 0.3f;
  EXPECT_EQ(label_by_paths(halves.costs, halves.luma, {}, {}).at(5, 5), 0);
}

TEST(LabelPaths, AnotherClassCountsAsAnEdge) {
  Halves halves;
  std::fill(halves.luma.data.begin(), halves.luma.data.end(), 0.5f);
  Image<uint16_t> classes(Halves::kWidth, Halves::kHeight, 1);
  for (int y = 0; y < Halves::kHeight; ++y) {
    for (int x = 0; x < Halves::kWidth; ++x) classes.at(x, y) = x < 5;
    halves.costs.at(0, y, 0) = 3;                    // the left border is of label 1
    halves.costs.at(Halves::kWidth - 1, y, 1) = 10;  // the right one of label 0
  }
  const LabelPathSettings settings;
  EXPECT_EQ(label_by_paths(halves.costs, halves.luma, {}, settings).at(4, 5), 0);
  EXPECT_EQ(label_by_paths(halves.costs, halves.luma, classes, settings).at(4, 5), 1);
  EXPECT_EQ(label_by_paths(halves.costs, halves.luma, classes, settings).at(5, 5), 0);
}

TEST(LabelPaths, OfEqualLabelsTheFirstIsTaken) {
  const Halves halves;
  for (const uint8_t label : label_by_paths(halves.costs, halves.luma, {}, {}).data) EXPECT_EQ(label, 0);
}

}  // namespace
}  // namespace aligngs
