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

TEST(Quantile, OfAnEmptyListIsZero) { EXPECT_EQ(quantile_of(std::vector<float>(), 0.5), 0); }

}  // namespace
}  // namespace aligngs
