#include "engine/formulas/semantic_sample.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(SemanticSample, TakesEveryPixelByDefault) {
  const SemanticSample all;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) EXPECT_TRUE(all.takes(x, y));
  }
  EXPECT_EQ(all.scale(), 1);
}

TEST(SemanticSample, EveryPixelHasItsTurnOnce) {
  for (const int quarters : {1, 2}) {
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) {
        int turns = 0;
        for (int phase = 8; phase < 8 + 4 / quarters; ++phase) turns += SemanticSample{quarters, phase}.takes(x, y) ? 1 : 0;
        EXPECT_EQ(turns, 1) << x << ", " << y;
      }
    }
  }
}

TEST(SemanticSample, TakesItsShareOfEveryTile) {
  for (const int quarters : {1, 2, 4}) {
    int taken = 0;
    for (int y = 16; y < 32; ++y) {
      for (int x = 48; x < 64; ++x) taken += SemanticSample{quarters, 3}.takes(x, y) ? 1 : 0;
    }
    EXPECT_EQ(taken, 64 * quarters);
    EXPECT_EQ(SemanticSample({quarters, 3}).scale() * static_cast<float>(taken), 256);
  }
}

}  // namespace
}  // namespace aligngs
