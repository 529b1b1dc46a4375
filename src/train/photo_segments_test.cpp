// A wall of Gaussians before a camera, a pixel each; the photo shows two things on it.
#include "train/photo_segments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace aligngs {
namespace {

constexpr int kSegmentColumns = 32, kSegmentRows = 24;
constexpr float kStep = 0.05f, kAway = 2;  // metres
constexpr uint16_t kChair = 19, kFloor = 3;

GaussianModel flat_wall() {
  GaussianModel model;
  model.resize(kSegmentColumns * kSegmentRows);
  for (int y = 0; y < kSegmentRows; ++y) {
    for (int x = 0; x < kSegmentColumns; ++x) {
      const size_t i = static_cast<size_t>(y * kSegmentColumns + x);
      const float p[3] = {kStep * (static_cast<float>(x - kSegmentColumns / 2) + 0.5f),
                          kStep * (static_cast<float>(y - kSegmentRows / 2) + 0.5f), kAway};
      for (size_t a = 0; a < 3; ++a) {
        model.positions[3 * i + a] = p[a];
        model.log_scales[3 * i + a] = std::log(a < 2 ? 0.3f * kStep : 0.03f * kStep);
      }
      model.rotations[4 * i] = 1;
      model.opacity_logits[i] = 4;
    }
  }
  return model;
}

/// The left third is a chair, the middle one another, the rest floor.
SegmentedView photo_of_chairs() {
  SegmentedView view;
  view.camera.width = kSegmentColumns;
  view.camera.height = kSegmentRows;
  view.camera.fx = view.camera.fy = kAway / kStep;
  view.camera.cx = kSegmentColumns / 2;
  view.camera.cy = kSegmentRows / 2;
  view.near_plane = 0.1f;
  view.segments = {kSegmentColumns, kSegmentRows, {}, {{kFloor, Segment::kStuff}, {kChair, 0}, {kChair, 1}}};
  for (int y = 0; y < kSegmentRows; ++y) {
    for (int x = 0; x < kSegmentColumns; ++x)
      view.segments.of_pixel.push_back(static_cast<uint16_t>(x < kSegmentColumns / 3       ? 1
                                                             : x < 2 * kSegmentColumns / 3 ? 2
                                                                                           : 0));
  }
  return view;
}

TEST(PhotoSegmentsOfAView, AreThoseThatTheGaussianIsSeenIn) {
  ThreadPool pool(2);
  const PhotoSegments seen = sighted_segments(flat_wall(), photo_of_chairs(), {}, pool);
  std::set<uint16_t> of_left, of_middle, of_right;
  for (const SegmentSighting& s : seen.seen) {
    if (s.gaussian == 12 * kSegmentColumns + 3) of_left.insert(s.segment);
    if (s.gaussian == 12 * kSegmentColumns + 16) of_middle.insert(s.segment);
    if (s.gaussian == 12 * kSegmentColumns + 28) of_right.insert(s.segment);
  }
  EXPECT_EQ(of_left, (std::set<uint16_t>{1}));
  EXPECT_EQ(of_middle, (std::set<uint16_t>{2}));
  EXPECT_EQ(of_right, (std::set<uint16_t>{SegmentMap::kNone})) << "floor is stuff";
}

TEST(PhotoSegmentsOfAView, OfStuffAloneAreNone) {
  ThreadPool pool(2);
  SegmentedView view = photo_of_chairs();
  view.segments.list = {{kFloor, Segment::kStuff}};
  view.segments.of_pixel.assign(kSegmentColumns * kSegmentRows, 0);
  EXPECT_TRUE(sighted_segments(flat_wall(), view, {}, pool).seen.empty());
}

TEST(PhotoSegmentsOfAView, AreTheSameForAnyNumberOfThreads) {
  std::vector<float> first;
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    std::vector<float> pixels;
    for (const SegmentSighting& s : sighted_segments(flat_wall(), photo_of_chairs(), {}, pool).seen)
      pixels.push_back(s.pixels);
    if (first.empty()) first = pixels;
    EXPECT_EQ(pixels, first);
  }
}

}  // namespace
}  // namespace aligngs
