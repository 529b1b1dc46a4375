#include "refine/sweep_rows.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/random.h"

namespace aligngs {
namespace {

TEST(SweepRows, RowsAreAddedInOrder) {
  Random random(3);
  for (const int terms : {1, 5, 7, 9}) {
    for (const int count : {1, 7, 8, 9, 40}) {
      std::vector<std::vector<float>> in(static_cast<size_t>(terms), std::vector<float>(static_cast<size_t>(count)));
      std::vector<const float*> rows;
      for (std::vector<float>& row : in) {
        for (float& v : row) v = static_cast<float>(random.uniform(-1, 1));
        rows.push_back(row.data());
      }
      std::vector<float> out(static_cast<size_t>(count));
      sum_rows(rows.data(), terms, count, out.data());
      for (size_t i = 0; i < out.size(); ++i) {
        float sum = in[0][i];
        for (size_t term = 1; term < in.size(); ++term) sum += in[term][i];
        EXPECT_EQ(out[i], sum) << terms << " rows of " << count << ", place " << i;
      }
    }
  }
}

TEST(SweepRows, ScoresThatAreNoneCountNotForTheCost) {
  constexpr float kNone = -2, kUnknown = 1;
  const std::vector<float> best{0.75f, 0.5f, kNone}, second{0.25f, kNone, kNone};
  std::vector<double> sums(3), counts(3);
  add_scores(3, best.data(), kNone, sums.data(), counts.data());
  add_scores(3, second.data(), kNone, sums.data(), counts.data());
  std::vector<float> costs(3);
  std::vector<uint8_t> known(3);
  cost_row(3, sums.data(), counts.data(), kUnknown, costs.data(), known.data());
  EXPECT_EQ(costs, (std::vector<float>{0.5f, 0.5f, kUnknown}));
  EXPECT_EQ(known, (std::vector<uint8_t>{1, 1, 0}));
}

TEST(SweepRows, TransposedCostsAreThoseOfThePixel) {
  constexpr size_t kRows = 3, kColumns = 130;
  std::vector<float> in(kRows * kColumns), out(in.size());
  for (size_t i = 0; i < in.size(); ++i) in[i] = static_cast<float>(i);
  transpose_costs(in.data(), kRows, kColumns, out.data());
  for (size_t c = 0; c < kColumns; ++c) {
    for (size_t r = 0; r < kRows; ++r) EXPECT_EQ(out[c * kRows + r], in[r * kColumns + c]);
  }
}

}  // namespace
}  // namespace aligngs
