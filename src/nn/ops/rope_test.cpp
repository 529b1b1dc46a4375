#include "nn/ops/rope.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

TEST(Rope2d, AnglesOfIntegerPlacesGiveTheSameRotation) {
  constexpr int64_t kDim = 16, kLargest = 6;
  std::vector<double> angles;
  for (int64_t p = 0; p <= kLargest; ++p) {
    for (int64_t j = 0; j < kDim / 4; ++j) angles.push_back(double(p) * std::pow(100.0, -double(j) / (kDim / 4)));
  }
  const Rope2d by_rule(kDim, kLargest), by_angles(kDim, angles);
  std::vector<float> a = random_values(kDim), b = a;
  by_rule.rotate(a.data(), 5, 2);
  by_angles.rotate(b.data(), 5, 2);
  EXPECT_EQ(a, b);
}

TEST(Rope2d, PlaceZeroTurnsNothingAndLengthsStay) {
  const Rope2d rope(8, 9);
  const std::vector<float> head = random_values(8);
  std::vector<float> still = head, turned = head;
  rope.rotate(still.data(), 0, 0);
  rope.rotate(turned.data(), 3, 7);
  EXPECT_EQ(still, head);
  EXPECT_NE(turned, head);
  double before = 0, after = 0;
  for (size_t i = 0; i < head.size(); ++i) {
    before += double(head[i]) * double(head[i]);
    after += double(turned[i]) * double(turned[i]);
  }
  EXPECT_NEAR(after, before, 1e-5);
}

}  // namespace
}  // namespace aligngs::nn
