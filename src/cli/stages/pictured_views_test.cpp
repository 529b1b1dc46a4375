#include "cli/stages/pictured_views.h"

#include <gmock/gmock.h>

#include <numeric>

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Scene scene_with(int training, std::vector<int> test) {
  Scene scene;
  scene.train.resize(static_cast<size_t>(training));
  std::iota(scene.train.begin(), scene.train.end(), 0);
  scene.test = std::move(test);
  return scene;
}

TEST(PicturedViews, AllTestViewsAreShown) {
  const PicturedViews pictured = pictured_views(scene_with(10, {10, 11}));
  EXPECT_STREQ(pictured.split, "test");
  EXPECT_THAT(pictured.views, ElementsAre(10, 11));
}

TEST(PicturedViews, WithoutTestViewsTrainingViewsFromFirstToLastAre) {
  const PicturedViews pictured = pictured_views(scene_with(28, {}));
  EXPECT_STREQ(pictured.split, "train");
  EXPECT_THAT(pictured.views, ElementsAre(0, 9, 18, 27));
}

TEST(PicturedViews, FewTrainingViewsAreAllShown) {
  EXPECT_THAT(pictured_views(scene_with(3, {})).views, ElementsAre(0, 1, 2));
  EXPECT_THAT(pictured_views(scene_with(1, {})).views, ElementsAre(0));
  EXPECT_THAT(pictured_views(scene_with(0, {})).views, IsEmpty());
}

}  // namespace
}  // namespace aligngs
