#include "core/quantile.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(Quantile, IsTheValueWithTheShareBelowIt) {
  const std::vector<double> values = {4, 1, 3, 0, 2, 5, 9, 8, 7, 6};
  EXPECT_EQ(quantile_of(values, 0), 0);
  EXPECT_EQ(quantile_of(values, 0.3), 3);
  EXPECT_EQ(quantile_of(values, 1), 9);
}

TEST(Quantile, RanksAreCountedFromTheFirstToTheLast) {
  const std::vector<int> values = {3, 0, 2, 1};  // ranks at 0, 1/3, 2/3 and 1
  EXPECT_EQ(nearest_rank_of(values, 0.6), 2);
  EXPECT_EQ(lower_rank_of(values, 0.6), 1);
  EXPECT_EQ(nearest_rank_of(values, 1), 3);
  EXPECT_EQ(lower_rank_of(values, 1), 3);
}

TEST(Quantile, OfAnEmptyListIsZero) { EXPECT_EQ(quantile_of(std::vector<float>(), 0.5), 0); }

}  // namespace
}  // namespace aligngs
