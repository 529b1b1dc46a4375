#include "engine/formulas/position_noise.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(PositionNoise, IsNormalWithTheSquareOfTheCovariance) {
  const float log_scales[3] = {std::log(2.0f), 0, std::log(0.5f)}, rotation[4] = {1, 0, 0, 0};
  Vec3d sum, squares;
  constexpr int kDraws = 20000;
  for (size_t i = 0; i < kDraws; ++i) {
    const Vec3<float> x = position_noise({1, 7}, i, 0.0f, log_scales, rotation);
    for (int k = 0; k < 3; ++k) {
      sum[k] += x[k];
      squares[k] += double(x[k]) * x[k];
    }
  }
  const double gate = 1 / (1 + std::exp(-0.5)), want[3] = {4 * gate, gate, 0.25 * gate};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sum[k] / kDraws, 0, 0.04 * want[k]);
    EXPECT_NEAR(std::sqrt(squares[k] / kDraws), want[k], 0.02 * want[k]);
  }
}

TEST(PositionNoise, OpaqueGaussiansStay) {
  const float log_scales[3] = {}, rotation[4] = {1, 0, 0, 0};
  EXPECT_EQ(norm(position_noise({1, 7}, 3, 0.5f, log_scales, rotation)), 0);
  EXPECT_LT(norm(position_noise({1, 7}, 3, 0.1f, log_scales, rotation)), 1e-3f);
}

TEST(PositionNoise, AnotherSeedOrRowIsAnotherDraw) {
  const float log_scales[3] = {}, rotation[4] = {1, 0, 0, 0};
  const float a = position_noise({1, 7}, 3, 0, log_scales, rotation).x;
  EXPECT_EQ(a, position_noise({1, 7}, 3, 0, log_scales, rotation).x);
  EXPECT_NE(a, position_noise({1, 8}, 3, 0, log_scales, rotation).x);
  EXPECT_NE(a, position_noise({1, 7}, 4, 0, log_scales, rotation).x);
}

}  // namespace
}  // namespace aligngs
