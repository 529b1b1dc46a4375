#include "nn/da3/reference_view.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace aligngs::nn {
namespace {

Matrix tokens_of(std::vector<std::vector<float>> rows) {
  Matrix m(int64_t(rows.size()), int64_t(rows[0].size()));
  for (size_t i = 0; i < rows.size(); ++i) std::copy(rows[i].begin(), rows[i].end(), m.row(int64_t(i)));
  return m;
}

TEST(ReferenceView, TheLeastExtremeViewIsChosen) {
  // The second lies between the others in direction and in length.
  const Matrix tokens = tokens_of({{1, 0, 0.1f}, {1.5f, 1.4f, 0.3f}, {0.2f, 4, 0.5f}});
  const Da3Reference chosen = choose_reference_view(tokens, Da3ReferenceRule::kSaddleBalanced);
  ASSERT_EQ(chosen.scores.size(), 3u);
  EXPECT_EQ(chosen.view, std::min_element(chosen.scores.begin(), chosen.scores.end()) - chosen.scores.begin());
  EXPECT_EQ(choose_reference_view(tokens, Da3ReferenceRule::kFirst).view, 0);
  EXPECT_EQ(choose_reference_view(tokens, Da3ReferenceRule::kMiddle).view, 1);
}

TEST(ReferenceView, TheFirstOfEqualViewsIsChosenAndNothingIsDividedByZero) {
  const Da3Reference chosen =
      choose_reference_view(tokens_of({{1, 2}, {1, 2}, {1, 2}}), Da3ReferenceRule::kSaddleBalanced);
  EXPECT_EQ(chosen.view, 0);
  for (const float score : chosen.scores) EXPECT_FLOAT_EQ(score, 1.5f);
  const Da3Reference blank = choose_reference_view(Matrix(1, 4), Da3ReferenceRule::kSaddleBalanced);
  EXPECT_EQ(blank.view, 0);
}

}  // namespace
}  // namespace aligngs::nn
