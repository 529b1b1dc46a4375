#include "nn/cpu/row_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/half.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

TEST(RowKernels, RoundToBfloat16AsTheScalarCodeDoes) {
  std::vector<float> x = random_values(101);
  x.insert(x.end(), {0.0f, -0.0f, 1.0f, 1.00390625f, 1.01171875f, -3e38f, 1e-40f});
  std::vector<uint16_t> rounded(x.size()), rectified(x.size());
  round_to_bfloat16(x.data(), int64_t(x.size()), false, rounded.data());
  round_to_bfloat16(x.data(), int64_t(x.size()), true, rectified.data());
  for (size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(bfloat16_to_float(rounded[i]), bfloat16_to_float(float_to_bfloat16(x[i])));
    EXPECT_EQ(bfloat16_to_float(rectified[i]), bfloat16_to_float(float_to_bfloat16(std::max(x[i], 0.0f))));
  }
}

TEST(RowKernels, ActivationsAreTheirDefinitions) {
  std::vector<float> x;
  for (double v = -12; v <= 12; v += 0.037) x.push_back(float(v));
  const auto activated = [&](Activation activation) {
    std::vector<float> y = x;
    add_bias_and_activate(y.data(), 1, int64_t(y.size()), nullptr, activation);
    return y;
  };
  const std::vector<float> gelu = activated(Activation::kGelu), silu = activated(Activation::kSilu),
                           relu = activated(Activation::kRelu);
  for (size_t i = 0; i < x.size(); ++i) {
    const double v = double(x[i]);
    EXPECT_NEAR(gelu[i], 0.5 * v * (1 + std::erf(v / std::sqrt(2.0))), 2e-6) << v;
    EXPECT_NEAR(silu[i], v / (1 + std::exp(-v)), 2e-6) << v;
    EXPECT_EQ(relu[i], std::max(x[i], 0.0f));
  }
}

TEST(RowKernels, SiluOfLargeNegativeValuesIsFinite) {
  float x[] = {-1000.0f, -1e30f, 1000.0f};
  add_bias_and_activate(x, 1, 3, nullptr, Activation::kSilu);
  EXPECT_NEAR(x[0], 0, 1e-30);
  EXPECT_TRUE(std::isfinite(x[1]));
  EXPECT_EQ(x[2], 1000);
}

TEST(RowKernels, LayerNormHasMeanZeroAndVarianceOne) {
  for (const int64_t columns : {1, 5, 16, 37}) {
    std::vector<float> x = random_values(size_t(columns * 3));
    for (float& v : x) v = 3 * v + 100;
    std::vector<float> y(x.size());
    layer_norm(x.data(), 3, columns, nullptr, nullptr, 1e-6f, y.data());
    for (int64_t r = 0; r < 3; ++r) {
      double mean = 0, square = 0;
      for (int64_t c = 0; c < columns; ++c) mean += double(y[size_t(r * columns + c)]);
      for (int64_t c = 0; c < columns; ++c) square += std::pow(double(y[size_t(r * columns + c)]), 2);
      EXPECT_NEAR(mean / double(columns), 0, 1e-4);
      if (columns > 1) {
        EXPECT_NEAR(square / double(columns), 1, 1e-3);
      }
    }
  }
}

TEST(RowKernels, LayerNormOfAConstantRowIsItsBias) {
  const std::vector<float> x(20, 7.0f), weight(20, 2.0f), bias(20, -1.0f);
  std::vector<float> y(20);
  layer_norm(x.data(), 1, 20, weight.data(), bias.data(), 1e-6f, y.data());
  for (const float v : y) EXPECT_EQ(v, -1);
}

TEST(RowKernels, SoftmaxSumsToOneForAnyScale) {
  std::vector<float> x = {1000, 999, -1000, 0, 1e30f, 1e30f, -1e30f, 5};
  softmax_rows(x.data(), 2, 4);
  EXPECT_NEAR(x[0], 1 / (1 + std::exp(-1.0)), 1e-6);
  EXPECT_NEAR(x[0] + x[1] + x[2] + x[3], 1, 1e-6);
  EXPECT_NEAR(x[4], 0.5, 1e-6);
}

TEST(RowKernels, AddScaledAddsToTheRows) {
  std::vector<float> x(21, 1.0f);
  const std::vector<float> y(21, 2.0f), bias(7, 3.0f), scale(7, 0.5f);
  add_scaled(x.data(), y.data(), 3, 7, bias.data(), scale.data());
  for (const float v : x) EXPECT_EQ(v, 3.5f);
}

}  // namespace
}  // namespace aligngs::nn
