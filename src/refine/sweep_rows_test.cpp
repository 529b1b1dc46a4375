#include "refine/sweep_rows.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/random.h"

namespace aligngs {
namespace {

TEST(SweepRows, StridedSumsAreAddedInOrder) {
  constexpr int kTerms = 7;
  Random random(3);
  for (const int count : {1, 7, 8, 9, 40}) {
    for (const size_t stride : {size_t{1}, static_cast<size_t>(count)}) {
      std::vector<float> in(static_cast<size_t>(count) + stride * kTerms), out(static_cast<size_t>(count));
      for (float& v : in) v = static_cast<float>(random.uniform(-1, 1));
      sum_strided(in.data(), stride, kTerms, count, out.data());
      for (size_t i = 0; i < out.size(); ++i) {
        float sum = in[i];
        for (size_t term = 1; term < kTerms; ++term) sum += in[i + term * stride];
        EXPECT_EQ(out[i], sum) << "count " << count << ", stride " << stride << ", place " << i;
      }
    }
  }
}

}  // namespace
}  // namespace aligngs
