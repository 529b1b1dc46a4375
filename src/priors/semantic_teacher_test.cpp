#include "priors/semantic_teacher.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr int kWall = 0, kChair = 19, kLamp = 36;

/// A lamp, a chair, the wall and another chair, in the order of their queries; the last pixel is of none.
nn::PanopticMap panoptic() {
  nn::PanopticMap map;
  map.width = 5;
  map.height = 1;
  map.segments = {0, 1, 2, 3, -1};
  map.list = {{0, kLamp, 0.9f}, {1, kChair, 0.9f}, {2, kWall, 0.9f}, {3, kChair, 0.9f}};
  return map;
}

TEST(SegmentMapOf, NumbersThingsWithinTheirClasses) {
  const SegmentMap map = segment_map_of(panoptic(), {kWall});
  ASSERT_EQ(map.list.size(), 4u);
  EXPECT_EQ(map.list[0].label, kWall);
  EXPECT_FALSE(map.list[0].is_thing());
  EXPECT_EQ(map.list[1].label, kChair);
  EXPECT_EQ(map.list[1].number, 0);
  EXPECT_EQ(map.list[2].number, 1);
  EXPECT_EQ(map.list[3].label, kLamp);
  EXPECT_EQ(map.of_pixel, (std::vector<uint16_t>{3, 1, 0, 2, SegmentMap::kNone}));
}

TEST(SegmentMapOf, NothingIsAMapWithoutSegments) {
  nn::PanopticMap none = panoptic();
  none.list.clear();
  none.segments.assign(5, -1);
  EXPECT_TRUE(segment_map_of(none, {kWall}).list.empty());
}

TEST(SegmentMapOf, MoreThingsThanAFileHoldsAreAnError) {
  nn::PanopticMap many = panoptic();
  many.list.assign(256, {0, kChair, 0.9f});
  EXPECT_THROW(segment_map_of(many, {kWall}), Error);
}

TEST(MakesSegments, OnlyThePanopticNetworkDoes) {
  EXPECT_TRUE(makes_segments(published_model("eomt-l-panoptic")));
  EXPECT_FALSE(makes_segments(published_model("eomt-l")));
  EXPECT_FALSE(makes_segments(published_model("ade20k-m2f")));
}

}  // namespace
}  // namespace aligngs
