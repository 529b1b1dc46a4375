#include "nn/eomt/panoptic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aligngs::nn {
namespace {

constexpr int kSide = 8, kClasses = 3;

/// Queries of a sure class whose masks are rectangles [left, right) over all rows of a square of 8 x 8.
class Scene {
 public:
  void add(int category, int left, int right, float certainty = 8) {
    queries_.push_back({category, left, right, certainty});
  }
  PanopticMap segments(const PanopticOptions& options) {
    EomtPrediction prediction;
    prediction.classes = Matrix(int64_t(queries_.size()), kClasses + 1);
    prediction.masks = FeatureMap(kSide, kSide, int64_t(queries_.size()));
    for (size_t q = 0; q < queries_.size(); ++q) {
      prediction.classes.row(int64_t(q))[queries_[q].category] = queries_[q].certainty;
      for (int64_t y = 0; y < kSide; ++y) {
        for (int64_t x = 0; x < kSide; ++x)
          prediction.masks.at(y, x)[q] = x >= queries_[q].left && x < queries_[q].right ? 6.0f : -6.0f;
      }
    }
    Compute compute(pool_);
    return panoptic_map(compute, prediction, {Image<uint8_t>(kSide, kSide, 3), kSide, kSide}, kSide, kSide, options);
  }

 private:
  struct Query {
    int category, left, right;
    float certainty;
  };
  std::vector<Query> queries_;
  ThreadPool pool_{1};
};

PanopticOptions stuff_is_class_0() {
  PanopticOptions options;
  options.stuff = {0};
  return options;
}

std::vector<int> first_row(const PanopticMap& map) { return {map.segments.begin(), map.segments.begin() + kSide}; }

TEST(Panoptic, ThingsOfOneClassStayApartAndStuffIsJoined) {
  Scene scene;
  scene.add(1, 0, 2);
  scene.add(1, 2, 4);
  scene.add(0, 4, 6);
  scene.add(0, 6, 8);
  const PanopticMap map = scene.segments(stuff_is_class_0());
  EXPECT_THAT(first_row(map), testing::ElementsAre(0, 0, 1, 1, 2, 2, 2, 2));
  ASSERT_EQ(map.list.size(), 3u);
  EXPECT_EQ(map.list[1].category, 1);
  EXPECT_EQ(map.list[2].category, 0);
  EXPECT_GT(map.list[0].score, 0.99f);
  EXPECT_EQ(map.categories[7], 0);
}

TEST(Panoptic, UnsureQueriesAndNoObjectsLeaveNothing) {
  Scene scene;
  scene.add(1, 0, 4, 0.5f);   // a share of less than 0.8
  scene.add(kClasses, 4, 8);  // "no object"
  const PanopticMap map = scene.segments(stuff_is_class_0());
  EXPECT_TRUE(map.list.empty());
  EXPECT_EQ(map.segments, std::vector<int>(64, -1));
  EXPECT_EQ(map.categories, std::vector<int>(64, kClasses));
}

TEST(Panoptic, AMaskThatOthersMostlyCoverIsRejectedAndItsRestStaysEmpty) {
  Scene scene;
  scene.add(1, 0, 8, 5);  // less sure than the next
  scene.add(2, 0, 5, 9);
  const PanopticMap map = scene.segments(stuff_is_class_0());
  EXPECT_THAT(first_row(map), testing::ElementsAre(0, 0, 0, 0, 0, -1, -1, -1));
  ASSERT_EQ(map.list.size(), 1u);
  EXPECT_EQ(map.list[0].category, 2);
}

TEST(Panoptic, TheStuffOfAde20kIsAThirdOfItsClasses) {
  EXPECT_EQ(ade20k_stuff_classes().size(), 50u);
  EXPECT_LT(ade20k_stuff_classes().back(), 150);
}

}  // namespace
}  // namespace aligngs::nn
