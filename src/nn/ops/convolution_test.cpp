#include "nn/ops/convolution.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "nn/ops/resize.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

FeatureMap random_map(int64_t height, int64_t width, int64_t channels) {
  FeatureMap map(height, width, channels);
  map.data = random_values(map.data.size(), 4);
  return map;
}

float plain(const FeatureMap& x, const std::vector<float>& w, const ConvolutionShape& s, int64_t y, int64_t column,
            int64_t o) {
  double sum = 0;
  for (int64_t ky = 0; ky < s.kernel; ++ky) {
    for (int64_t kx = 0; kx < s.kernel; ++kx) {
      const int64_t v = y * s.stride + ky - s.padding, u = column * s.stride + kx - s.padding;
      if (v < 0 || u < 0 || v >= x.height || u >= x.width) continue;
      for (int64_t i = 0; i < s.inputs; ++i) {
        const auto at = size_t(((o * s.inputs + i) * s.kernel + ky) * s.kernel + kx);
        sum += double(w[at]) * double(x.at(v, u)[i]);
      }
    }
  }
  return float(sum);
}

TEST(Convolution, IsItsDefinition) {
  ThreadPool pool(2);
  Compute compute(pool);
  for (const ConvolutionShape& s :
       {ConvolutionShape{5, 3, 3, 1, 1}, ConvolutionShape{4, 2, 3, 2, 1}, ConvolutionShape{3, 3, 7, 7, 0},
        ConvolutionShape{2, 6, 1, 1, 0}, ConvolutionShape{2, 3, 5, 1, 2}}) {
    const std::vector<float> w = random_values(size_t(s.outputs * s.inputs * s.kernel * s.kernel));
    const FeatureMap x = random_map(14, 21, s.inputs);
    const FeatureMap y = Convolution(compute, s, w, {})(compute, x);
    for (int64_t row = 0; row < y.height; ++row) {
      for (int64_t column = 0; column < y.width; ++column) {
        for (int64_t o = 0; o < s.outputs; ++o)
          ASSERT_NEAR(y.at(row, column)[o], plain(x, w, s, row, column, o), 1e-4f);
      }
    }
  }
}

TEST(Convolution, AMapNarrowerThanTheKernelWorksWithPadding) {
  ThreadPool pool(1);
  Compute compute(pool);
  const ConvolutionShape s{1, 1, 5, 1, 2};
  const std::vector<float> w(25, 1.0f);
  FeatureMap x(1, 1, 1);
  x.data = {3};
  const FeatureMap y = Convolution(compute, s, w, {1})(compute, x);
  ASSERT_EQ(y.data.size(), 1u);
  EXPECT_EQ(y.data[0], 4);
}

TEST(Convolution, AMapOfOtherChannelsIsRefused) {
  ThreadPool pool(1);
  Compute compute(pool);
  const Convolution c(compute, {1, 2, 3, 1, 1}, std::vector<float>(18), {});
  EXPECT_THROW(c(compute, FeatureMap(4, 4, 3)), Error);
}

TEST(Resample, ConstantsStayAndEndsMeet) {
  ThreadPool pool(2);
  Compute compute(pool);
  FeatureMap x(3, 4, 2);
  for (float& v : x.data) v = 5;
  for (const float v : resize_bilinear_map(compute, x, 7, 9, false).data) EXPECT_NEAR(v, 5, 1e-5);
  const FeatureMap map = random_map(3, 4, 2);
  const FeatureMap corners = resize_bilinear_map(compute, map, 9, 10, true);
  EXPECT_NEAR(corners.at(8, 9)[1], map.at(2, 3)[1], 1e-6);
  EXPECT_NEAR(corners.at(0, 9)[0], map.at(0, 3)[0], 1e-6);
}

TEST(MaxPool, TakesTheLargestOfEachWindow) {
  ThreadPool pool(1);
  Compute compute(pool);
  FeatureMap x(3, 5, 1);
  for (size_t i = 0; i < x.data.size(); ++i) x.data[i] = -float(i);
  EXPECT_EQ(max_pool_2x2(compute, x).data, (std::vector<float>{0, -2}));
  EXPECT_EQ(max_pool_3x3_stride_2(compute, x).data, (std::vector<float>{0, -1, -3, -5, -6, -8}));
}

}  // namespace
}  // namespace aligngs::nn
