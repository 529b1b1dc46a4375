// Two boxes of one class that touch, before a wall.
#include "synth/teacher_panoptic.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

constexpr uint16_t kWall = 0, kBox = 41;

RenderedView two_boxes() {
  RenderedView view;
  view.labels = Image<uint16_t>(80, 60, 1, kWall);
  view.instances = Image<uint16_t>(80, 60, 1, 0);
  view.depth = ImageF(80, 60, 1, 2.5f);
  for (int y = 20; y < 44; ++y) {
    for (int x = 16; x < 64; ++x) {
      view.labels.at(x, y) = kBox;
      view.instances.at(x, y) = x < 40 ? 1 : 2;
    }
  }
  return view;
}

RoomModel room_of_boxes() {
  RoomModel room;
  room.objects.resize(3);
  room.objects[0].label = kWall;
  room.objects[1].label = room.objects[2].label = kBox;
  return room;
}

/// A network without any error.
PanopticTeacherSettings perfect() {
  PanopticTeacherSettings s;
  s.outline_rms = 0.01;
  s.missed = s.missed_small = s.missed_large = s.merged = s.merged_apart = s.split = s.flip = 0;
  return s;
}

class PanopticTeacher : public testing::Test {
 protected:
  SegmentMap seen(const PanopticTeacherSettings& settings) {
    return simulate_panoptic_teacher({two_boxes()}, room_of_boxes(), std::vector<ObjectConfusion>(3), settings, {},
                                     Random(1), pool_)[0];
  }
  double quality(const SegmentMap& said) const { return panoptic_quality({exact_segments(two_boxes())}, {said}); }

  ThreadPool pool_{2};
};

TEST_F(PanopticTeacher, ExactSegmentsAreTheObjectsAndOneWall) {
  const SegmentMap exact = exact_segments(two_boxes());
  ASSERT_EQ(exact.list.size(), 3u);
  EXPECT_FALSE(exact.list[0].is_thing());
  EXPECT_EQ(exact.list[1].label, kBox);
  EXPECT_EQ(exact.list[2].number, 1);
  EXPECT_DOUBLE_EQ(quality(exact), 1);
}

TEST_F(PanopticTeacher, WithoutErrorsItTellsTheBoxesApart) {
  const SegmentMap map = seen(perfect());
  EXPECT_EQ(map.list.size(), 3u);
  EXPECT_GT(quality(map), 0.85);
}

TEST_F(PanopticTeacher, MergedThingsAreOneSegmentAndMatchNone) {
  PanopticTeacherSettings settings = perfect();
  settings.merged = 1;
  const SegmentMap map = seen(settings);
  EXPECT_EQ(map.list.size(), 2u);
  EXPECT_LT(quality(map), 0.6);
}

TEST_F(PanopticTeacher, ASplitThingIsTwoSegments) {
  PanopticTeacherSettings settings = perfect();
  settings.split = 1;
  settings.half_missed = 0;
  EXPECT_EQ(seen(settings).list.size(), 5u);
}

TEST_F(PanopticTeacher, MissedThingsHaveNoSegment) {
  PanopticTeacherSettings settings = perfect();
  settings.missed = settings.missed_small = settings.missed_large = 1;
  const SegmentMap map = seen(settings);
  ASSERT_EQ(map.list.size(), 1u);
  EXPECT_EQ(map.list[0].label, kWall);
}

TEST_F(PanopticTeacher, IsTheSameForAnyNumberOfThreads) {
  const std::vector<RenderedView> views(3, two_boxes());
  std::vector<uint16_t> first;
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    const auto maps =
        simulate_panoptic_teacher(views, room_of_boxes(), std::vector<ObjectConfusion>(3), {}, {}, Random(5), pool);
    std::vector<uint16_t> all;
    for (const SegmentMap& map : maps) all.insert(all.end(), map.of_pixel.begin(), map.of_pixel.end());
    if (first.empty()) first = all;
    EXPECT_EQ(all, first);
  }
}

TEST(PanopticQuality, HalfAMatchWithoutPartnerLowersIt) {
  const SegmentMap truth{4, 1, {0, 0, 1, 1}, {{kBox, 0}, {kBox, 1}}};
  const SegmentMap one{4, 1, {0, 0, SegmentMap::kNone, SegmentMap::kNone}, {{kBox, 0}}};
  EXPECT_DOUBLE_EQ(panoptic_quality({truth}, {one}), 1 / 1.5);
}

TEST(PanopticQuality, NothingIsZero) { EXPECT_EQ(panoptic_quality({}, {}), 0); }

}  // namespace
}  // namespace aligngs
