#include "nn/cuda/lt_layout.h"

#include <gtest/gtest.h>

#include <vector>

#include "nn/testing/weights.h"

namespace aligngs::cuda {
namespace {

/// The product that a layout describes, by its definition.
std::vector<float> described_product(const LtLayout& layout, const std::vector<float>& left,
                                     const std::vector<float>& right) {
  const auto element = [](const ColumnMajorMatrix& m, const std::vector<float>& values, int64_t row, int64_t column) {
    return m.transposed ? values.at(size_t(row * m.leading + column)) : values.at(size_t(column * m.leading + row));
  };
  const int64_t depth = layout.left.transposed ? layout.left.rows : layout.left.columns;
  std::vector<float> result(size_t(layout.result.columns * layout.result.leading));
  for (int64_t c = 0; c < layout.result.columns; ++c) {
    for (int64_t r = 0; r < layout.result.rows; ++r) {
      float sum = 0;
      for (int64_t k = 0; k < depth; ++k) sum += element(layout.left, left, r, k) * element(layout.right, right, k, c);
      result.at(size_t(c * layout.result.leading + r)) = sum;
    }
  }
  return result;
}

TEST(LtLayout, DescribesRowsTimesWeightsToTheBit) {
  struct Size {
    int64_t rows, outputs, depth;
  };
  for (const Size& s : {Size{3, 5, 7}, Size{7, 5, 3}, Size{1, 4, 32}, Size{4, 1, 32}, Size{1, 1, 1}}) {
    const std::vector<float> x = nn::random_values(size_t(s.rows * s.depth), 1);
    const std::vector<float> w = nn::random_values(size_t(s.outputs * s.depth), 2);
    std::vector<float> expected;
    for (int64_t r = 0; r < s.rows; ++r) {
      for (int64_t o = 0; o < s.outputs; ++o) {
        float sum = 0;
        for (int64_t k = 0; k < s.depth; ++k) sum += w[size_t(o * s.depth + k)] * x[size_t(r * s.depth + k)];
        expected.push_back(sum);
      }
    }
    EXPECT_EQ(described_product(lt_layout(s.rows, s.outputs, s.depth), w, x), expected) << s.rows;
  }
}

TEST(LtLayout, DimensionsAreWhatTheLibraryAsksFor) {
  constexpr LtLayout l = lt_layout(3, 5, 7);
  // op(left) [m, k], op(right) [k, n], result [m, n]; no leading dimension below the rows that it separates.
  EXPECT_EQ(l.left.columns, l.result.rows);
  EXPECT_EQ(l.left.rows, l.right.rows);
  EXPECT_EQ(l.right.columns, l.result.columns);
  for (const ColumnMajorMatrix& m : {l.left, l.right, l.result}) EXPECT_GE(m.leading, m.rows);
}

TEST(LtEpilogue, OnlyFormulasThatAreTheProjectsOwnAreLeftToTheLibrary) {
  using nn::Activation;
  EXPECT_TRUE(lt_epilogue(true, Activation::kNone).bias);
  EXPECT_FALSE(lt_epilogue(true, Activation::kNone).relu);
  EXPECT_FALSE(lt_epilogue(false, Activation::kNone).bias);
  EXPECT_TRUE(lt_epilogue(true, Activation::kRelu).bias);
  EXPECT_TRUE(lt_epilogue(false, Activation::kRelu).relu);
  for (const Activation a : {Activation::kNone, Activation::kRelu}) EXPECT_FALSE(lt_epilogue(true, a).activate_after);
  for (const Activation a : {Activation::kGelu, Activation::kSilu}) {
    for (const bool bias : {false, true}) {
      EXPECT_TRUE(lt_epilogue(bias, a).activate_after);
      EXPECT_FALSE(lt_epilogue(bias, a).bias);  // else it would be added twice
      EXPECT_FALSE(lt_epilogue(bias, a).relu);
    }
  }
}

TEST(LtAlignment, IsThatOfTheAddressUpToWhatTheLibraryAssumes) {
  const auto at = [](uintptr_t address) { return alignment_of(reinterpret_cast<const void*>(address)); };
  EXPECT_EQ(at(0x1004), 4u);
  EXPECT_EQ(at(0x1010), 16u);
  EXPECT_EQ(at(0x10100), 256u);
  EXPECT_EQ(at(0x10000), 256u);
  EXPECT_EQ(at(0), 256u);
}

}  // namespace
}  // namespace aligngs::cuda
