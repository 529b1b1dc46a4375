#include "engine/cpu/activations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace aligngs::cpu {
namespace {

TEST(Activations, FollowTheLibraryForEveryLength) {
  for (const size_t count : {0, 1, 15, 16, 17, 50}) {
    std::vector<float> in(count), exps(count), sigmoids(count);
    for (size_t i = 0; i < count; ++i) in[i] = -20.0f + 0.8f * static_cast<float>(i);
    exp_range(in.data(), count, exps.data());
    sigmoid_range(in.data(), count, sigmoids.data());
    for (size_t i = 0; i < count; ++i) {
      const double x = static_cast<double>(in[i]);
      EXPECT_NEAR(exps[i], std::exp(x), 4e-7 * std::exp(x));
      EXPECT_NEAR(sigmoids[i], 1 / (1 + std::exp(-x)), 4e-7);
    }
  }
}

TEST(Activations, BeyondTheRangeAreInfinityAndAlmostNothing) {
  const float in[2] = {90.0f, -200.0f};
  float out[2];
  exp_range(in, 2, out);
  EXPECT_TRUE(std::isinf(out[0]));
  EXPECT_LT(out[1], 2e-38f);
  sigmoid_range(in, 2, out);
  EXPECT_EQ(out[0], 1.0f);
  EXPECT_LT(out[1], 1e-37f);
}

}  // namespace
}  // namespace aligngs::cpu
