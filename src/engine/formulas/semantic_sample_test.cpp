#include "engine/formulas/semantic_sample.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(SemanticSample, TakesEveryPixelByDefault) {
  const SemanticSample all;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) EXPECT_TRUE(all.takes(x, y));
  }
  EXPECT_EQ(all.scale(), 1);
}

TEST(SemanticSample, EveryPixelHasItsTurnOnce) {
  for (const int quarters : {1, 2}) {
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        int turns = 0;
        for (int phase = 8; phase < 8 + 4 / quarters; ++phase)
          turns += SemanticSample{quarters, phase}.takes(x, y) ? 1 : 0;
        EXPECT_EQ(turns, 1) << x << ", " << y;
      }
    }
  }
}

TEST(SemanticSample, TakesItsShareOfFourSquares) {
  for (const int quarters : {1, 2, 4}) {
    int taken = 0;
    for (int y = 128; y < 256; ++y) {
      for (int x = 64; x < 192; ++x) taken += SemanticSample{quarters, 3}.takes(x, y) ? 1 : 0;
    }
    EXPECT_EQ(taken, 64 * 64 * quarters);
    EXPECT_EQ((SemanticSample{quarters, 3}).scale() * static_cast<float>(taken), 128 * 128);
  }
}

TEST(SemanticSample, TakesWholeTiles) {
  const SemanticSample quarter{1, 2, SemanticSample::kTileShift};
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x)
      EXPECT_EQ(quarter.takes(x, y), quarter.takes(x / 16 * 16, y / 16 * 16)) << x << ", " << y;
  }
}

TEST(SemanticSample, SquaresGrowWithTheImage) {
  const auto edge = [](int side) { return 1 << make_semantic_sample(0.25, 0, side).square_shift; };
  EXPECT_EQ(edge(1), 16);
  EXPECT_EQ(edge(320), 64);
  EXPECT_EQ(edge(447), 64);
  EXPECT_EQ(edge(448), 128);
  EXPECT_EQ(edge(640), 128);
  EXPECT_EQ(edge(4000), 1024);
}

TEST(SemanticSample, SharesAreQuarters) {
  EXPECT_EQ(make_semantic_sample(1, 7, 320).quarters, 4);
  EXPECT_EQ(make_semantic_sample(0.5, 7, 320).quarters, 2);
  EXPECT_EQ(make_semantic_sample(0.25, 7, 320).quarters, 1);
  EXPECT_EQ(make_semantic_sample(0.25, 7, 320).phase, 7);
}

}  // namespace
}  // namespace aligngs
