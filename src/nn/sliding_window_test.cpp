#include "nn/sliding_window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs::nn {
namespace {

using testing::ElementsAre;

/// A map whose value is its column.
FeatureMap columns(int64_t height, int64_t width) {
  FeatureMap map(height, width, 1);
  for (int64_t p = 0; p < map.places(); ++p) map.data[size_t(p)] = float(p % width);
  return map;
}

class SlidingWindowTest : public testing::Test {
 protected:
  ThreadPool pool{2};
  Compute compute{pool};
};

TEST_F(SlidingWindowTest, TheLastWindowEndsWithTheImage) {
  std::vector<float> lefts;
  slide(compute, columns(4, 10), {4, 4, 3, 3}, [&](const FeatureMap& part) {
    EXPECT_EQ(part.width, 4);
    lefts.push_back(part.data[0]);
    return part;
  });
  EXPECT_THAT(lefts, ElementsAre(0, 3, 6));
  lefts.clear();
  slide(compute, columns(4, 11), {4, 4, 3, 3}, [&](const FeatureMap& part) {
    lefts.push_back(part.data[0]);
    return part;
  });
  EXPECT_THAT(lefts, ElementsAre(0, 3, 6, 7));
}

TEST_F(SlidingWindowTest, OverlappingValuesAreAveraged) {
  int window = 0;
  const FeatureMap out = slide(compute, columns(1, 6), {1, 4, 1, 2}, [&](const FeatureMap& part) {
    FeatureMap same = part;
    for (float& v : same.data) v = float(window);
    ++window;
    return same;
  });
  EXPECT_THAT(out.data, ElementsAre(0, 0, 0.5f, 0.5f, 1, 1));
}

TEST_F(SlidingWindowTest, AnImageSmallerThanTheWindowIsOneWindow) {
  int calls = 0;
  slide(compute, columns(3, 5), {10, 10, 5, 5}, [&](const FeatureMap& part) {
    ++calls;
    EXPECT_EQ(part.width, 5);
    return part;
  });
  EXPECT_EQ(calls, 1);
}

TEST_F(SlidingWindowTest, AWindowWithoutAStrideIsRefused) {
  EXPECT_THROW(slide(compute, columns(9, 9), {4, 4, 0, 0}, [](const FeatureMap& part) { return part; }), Error);
}

TEST_F(SlidingWindowTest, FlippingTwiceChangesNothing) {
  const FeatureMap map = columns(3, 5);
  EXPECT_EQ(flip_horizontally(flip_horizontally(map)).data, map.data);
  EXPECT_EQ(flip_horizontally(map).data[0], 4);
}

}  // namespace
}  // namespace aligngs::nn
