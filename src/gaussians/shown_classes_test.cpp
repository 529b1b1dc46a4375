#include "gaussians/shown_classes.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

GaussianModel with_rows(int channels, std::vector<float> semantics) {
  GaussianModel model;
  model.semantic_channels = channels;
  model.resize(semantics.size() / static_cast<size_t>(channels));
  model.semantics = std::move(semantics);
  return model;
}

TEST(ShownClasses, LeavesOutThoseThatNoRowTakesForPossible) {
  GaussianModel model = with_rows(4, {0, -30, 9, -30,  //
                                      -30, -30, 0, -10});
  EXPECT_EQ(keep_shown_classes(model), (std::vector<uint16_t>{0, 2, 3}));
  EXPECT_EQ(model.semantic_channels, 3);
  EXPECT_EQ(model.semantics, (std::vector<float>{0, 9, -30, -30, 0, -10}));
}

TEST(ShownClasses, RowsWithoutAClassDoNotCount) {
  GaussianModel model = with_rows(3, {0, 0, 0, -30, -30, 0});
  EXPECT_EQ(keep_shown_classes(model), (std::vector<uint16_t>{0, 2})) << "class 0 is that of such rows";
}

TEST(ShownClasses, AModelWithoutSemanticsStays) {
  GaussianModel model;
  model.resize(2);
  EXPECT_TRUE(keep_shown_classes(model).empty());
  EXPECT_EQ(model.size(), 2u);
}

}  // namespace
}  // namespace aligngs
