#include "engine/prepare_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/half.h"
#include "engine/edge_band.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

// Two frontal walls at depths 2 and 3 that meet between columns 9 and 10, labelled 0 and 1; grey photo.
ViewData two_walls(int width = 20, int height = 12) {
  ViewData data;
  data.name = "room";
  data.camera.width = width;
  data.camera.height = height;
  data.camera.fx = data.camera.fy = 20;
  data.camera.cx = 0.5 * width;
  data.camera.cy = 0.5 * height;
  data.color = ImageF(width, height, 3, 0.5f);
  data.prior_depth = ImageF(width, height, 1, 2.0f);
  data.labels = Image<uint16_t>(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 10; x < width; ++x) {
      data.prior_depth.at(x, y) = 3;
      data.labels.at(x, y) = 1;
    }
  }
  return data;
}

// Half-size teacher of 4 classes: `sure` gives one class everything, otherwise all classes are equal.
void add_teacher(ViewData& data, bool sure) {
  SemanticTarget& t = data.semantics;
  t.channels = 4;
  t.width = data.camera.width / 2;
  t.height = data.camera.height / 2;
  const size_t pixels = size_t(t.width) * t.height;
  t.confidence.assign(pixels, 1.0f);
  const uint16_t zero = 0, one = 0x3c00, quarter = 0x3400;  // float16
  ASSERT_EQ(half_to_float(one), 1.0f);
  ASSERT_EQ(half_to_float(quarter), 0.25f);
  for (size_t i = 0; i < pixels; ++i) {
    for (int c = 0; c < 4; ++c) t.probabilities.push_back(sure ? (c == 0 ? one : zero) : quarter);
  }
}

TEST(EdgeBand, CoversTheGivenNumberOfPixelsOnEitherSide) {
  for (const int radius : {1, 2, 3}) {
    const Image<uint8_t> band = edge_band(20, 5, radius, [](size_t i, size_t j) { return i % 20 == 9 && j == i + 1; });
    for (int x = 0; x < 20; ++x) EXPECT_EQ(band.at(x, 2), x > 9 - radius && x < 10 + radius) << x << " " << radius;
  }
}

TEST(PrepareView, TheLabelEdgeIsTwoPixelsOnEitherSide) {
  const TrainingView view = prepare_view(two_walls());
  for (int x = 0; x < 20; ++x) EXPECT_EQ(view.label_edge.at(x, 4), x >= 8 && x <= 11) << x;
}

TEST(PrepareView, ThePapersLabelEdgeIsTheFirstPixelOfEachPair) {
  ViewData data = two_walls();
  data.labels.at(3, 6) = 2;  // differs from its neighbours: itself, the one to its left and the one above
  PrepareOptions options;
  options.paper = true;
  const TrainingView view = prepare_view(data, options);
  for (int x = 4; x < 20; ++x) EXPECT_EQ(view.label_edge.at(x, 6), x == 9) << x;
  EXPECT_EQ(view.label_edge.at(3, 6), 1);
  EXPECT_EQ(view.label_edge.at(2, 6), 1);
  EXPECT_EQ(view.label_edge.at(3, 5), 1);
  EXPECT_EQ(view.label_edge.at(3, 7), 0);
}

TEST(PrepareView, UnknownLabelsMakeNoEdge) {
  ViewData data = two_walls();
  for (int y = 0; y < 12; ++y) data.labels.at(9, y) = data.labels.at(10, y) = kNoLabel;
  for (const bool paper : {false, true}) {
    PrepareOptions options;
    options.paper = paper;
    const TrainingView view = prepare_view(data, options);
    for (const uint8_t e : view.label_edge.data) EXPECT_EQ(e, 0);
  }
}

TEST(PrepareView, DepthWeightIsZeroWithinThreePixelsOfADiscontinuity) {
  const TrainingView view = prepare_view(two_walls());
  for (int x = 0; x < 20; ++x) EXPECT_EQ(view.depth_weight.at(x, 4), x >= 7 && x <= 12 ? 0 : 1) << x;
}

TEST(PrepareView, DepthWeightIsZeroWhereThereIsNoDepth) {
  ViewData data = two_walls();
  data.prior_depth.at(2, 2) = 0;
  data.prior_depth.at(3, 2) = std::numeric_limits<float>::quiet_NaN();
  data.prior_depth.at(4, 2) = std::numeric_limits<float>::infinity();
  const TrainingView view = prepare_view(data);
  for (int x = 2; x < 5; ++x) EXPECT_EQ(view.depth_weight.at(x, 2), 0);
  EXPECT_EQ(view.depth_weight.at(5, 2), 1);
}

TEST(PrepareView, DepthWeightRisesBetweenTwoQuantilesOfTheConfidence) {
  ImageF depth(101, 1, 1, 2.0f), confidence(101, 1, 1);
  for (int x = 0; x <= 100; ++x) confidence.at(x, 0) = float(10 + x);
  const ImageF weight = depth_weight_map(depth, &confidence, {});
  EXPECT_EQ(weight.at(10, 0), 0);
  EXPECT_EQ(weight.at(20, 0), 0);
  EXPECT_NEAR(weight.at(40, 0), 0.5, 1e-6);
  EXPECT_EQ(weight.at(60, 0), 1);
  EXPECT_EQ(weight.at(90, 0), 1);
}

TEST(PrepareView, AConstantConfidenceMeansNothing) {
  const ImageF depth(20, 5, 1, 2.0f), confidence(20, 5, 1, 7.0f);
  for (const float w : depth_weight_map(depth, &confidence, {}).data) EXPECT_EQ(w, 1);
}

TEST(PrepareView, AConfidenceThatIsNoNumberWeighsNothing) {
  const ImageF depth(20, 5, 1, 2.0f);
  ImageF confidence(20, 5, 1, 7.0f);
  confidence.at(3, 3) = std::numeric_limits<float>::quiet_NaN();
  // nothing is known of most of it
  for (int x = 5; x < 20; ++x) confidence.at(x, 0) = confidence.at(x, 1) = confidence.at(x, 2) = 0;
  const ImageF weight = depth_weight_map(depth, &confidence, {});
  EXPECT_EQ(weight.at(3, 3), 0);
  EXPECT_EQ(weight.at(10, 1), 0);
  EXPECT_EQ(weight.at(1, 1), 1);
}

TEST(PrepareView, PriorNormalsFaceTheCamera) {
  const TrainingView view = prepare_view(two_walls());
  EXPECT_NEAR(view.prior_normal.at(4, 5, 2), -1, 1e-5);
  EXPECT_NEAR(view.prior_normal.at(15, 5, 2), -1, 1e-5);
}

TEST(PrepareView, ASureTeacherWeighsOneAndAnEvenOneNothing) {
  for (const bool sure : {true, false}) {
    ViewData data = two_walls();
    add_teacher(data, sure);
    const TrainingView view = prepare_view(data);
    EXPECT_NEAR(view.semantic_weight.at(2, 4), sure ? 1 : 0, 1e-5);
  }
}

TEST(PrepareView, ATeacherEdgeCountsOnlyWhereColourOrDepthHasOne) {
  ViewData data = two_walls();
  add_teacher(data, true);
  EXPECT_NEAR(prepare_view(data).semantic_weight.at(9, 4), 1, 1e-5);  // the depth jumps there

  std::fill(data.prior_depth.data.begin(), data.prior_depth.data.end(), 2.0f);
  const TrainingView bare = prepare_view(data);
  for (int x = 0; x < 20; ++x) EXPECT_NEAR(bare.semantic_weight.at(x, 4), x >= 7 && x <= 12 ? 0 : 1, 1e-5) << x;

  for (int y = 0; y < 12; ++y) {
    for (int x = 12; x < 20; ++x) data.color.at(x, y, 1) = 0.7f;  // a colour edge two pixels off
  }
  const TrainingView colored = prepare_view(data);
  EXPECT_NEAR(colored.semantic_weight.at(9, 4), 1, 1e-5);
  EXPECT_EQ(colored.semantic_weight.at(7, 4), 0);
}

TEST(PrepareView, WhereTheTeacherSaysNothingTheWeightIsZero) {
  ViewData data = two_walls();
  add_teacher(data, true);
  std::fill(data.semantics.confidence.begin(), data.semantics.confidence.begin() + 10, 0.0f);  // first teacher row
  const TrainingView view = prepare_view(data);
  EXPECT_EQ(view.semantic_weight.at(2, 0), 0);
  EXPECT_NEAR(view.semantic_weight.at(2, 6), 1, 1e-5);
}

TEST(PrepareView, WithoutPriorsTheMapsStayEmpty) {
  ViewData data = two_walls();
  data.prior_depth = {};
  data.labels = {};
  const TrainingView view = prepare_view(data);
  EXPECT_TRUE(view.depth_weight.empty());
  EXPECT_TRUE(view.prior_normal.empty());
  EXPECT_TRUE(view.semantic_weight.empty());
  EXPECT_TRUE(view.label_edge.empty());
  EXPECT_EQ(view.data.color.pixels(), 240u);
}

TEST(PrepareView, AMapOfAnotherSizeIsBadInput) {
  ViewData data = two_walls();
  data.prior_depth = ImageF(10, 6, 1, 2.0f);
  try {
    prepare_view(data);
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(e.details().field, "prior_depth");
  }
}

TEST(PrepareView, ATruncatedTeacherIsBadInput) {
  ViewData data = two_walls();
  add_teacher(data, true);
  data.semantics.probabilities.pop_back();
  EXPECT_THROW(prepare_view(data), Error);
}

}  // namespace
}  // namespace aligngs
