#include "refine/plane_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr uint16_t kWallLabel = 0, kFloorLabel = 1, kGlassLabel = 2, kOtherLabel = 3;
const std::vector<PlaneClass> kClasses = {
    {PlaneKind::kWall, false}, {PlaneKind::kFloor, false}, {PlaneKind::kWall, true}, {}};

/// Photos of the textured corner, each with depth that is bent in its own way, and true labels of its walls and floor.
struct LabelledPhotos {
  std::vector<PlaneView> views;
  std::vector<ImageF> truth;
  ThreadPool pool{2};

  explicit LabelledPhotos(double bend, int count = 6) {
    for (int i = 0; i < count; ++i) {
      const MatchView exact = photo(true_camera(i)).match;
      PlaneView view;
      view.camera = exact.camera;
      view.depth = exact.depth;
      view.labels = Image<uint16_t>(kWidth, kHeight, 1);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Vec3d world = exact.camera.unproject(x + 0.5, y + 0.5, exact.depth.at(x, y));
          view.labels.at(x, y) = world.y > 0.79 ? kFloorLabel : kWallLabel;
          view.depth.at(x, y) *= static_cast<float>(std::exp(bend * std::sin(0.05 * x + i) * std::cos(0.03 * y)));
        }
      }
      truth.push_back(exact.depth);
      views.push_back(std::move(view));
    }
  }

  PlaneDepthResult measure() { return measure_planes(views, kClasses, {}, pool); }

  /// Median relative error of the depth of view i where `counts`.
  double error(size_t i, const PlaneMeasurement& m, bool corrected) const {
    std::vector<double> errors;
    for (size_t p = 0; p < truth[i].pixels(); ++p) {
      if (m.weight.data[p] <= 0) continue;
      const double factor = corrected ? std::exp(static_cast<double>(m.log_factor.data[p])) : 1.0;
      errors.push_back(std::abs(views[i].depth.data[p] * factor / truth[i].data[p] - 1));
    }
    if (errors.empty()) return 1;
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return errors[errors.size() / 2];
  }
};

TEST(PlaneDepth, StraightensBentWallsAndFloor) {
  LabelledPhotos photos(0.04);
  const PlaneDepthResult result = photos.measure();
  EXPECT_EQ(result.planes.size(), 3u);
  EXPECT_GT(result.share, 0.6);
  for (size_t i = 0; i < photos.views.size(); ++i) {
    EXPECT_LT(photos.error(i, result.views[i], true), 0.4 * photos.error(i, result.views[i], false)) << i;
  }
}

TEST(PlaneDepth, WhatStandsInFrontOfAWallStays) {
  LabelledPhotos photos(0);
  for (int y = 20; y < 50; ++y) {
    for (int x = 20; x < 60; ++x) photos.views[2].depth.at(x, y) *= 0.7f;  // a wardrobe that the teacher calls wall
  }
  const PlaneDepthResult result = photos.measure();
  EXPECT_EQ(result.views[2].weight.at(40, 35), 0);
  EXPECT_GT(result.views[2].weight.at(90, 35), 0);
}

TEST(PlaneDepth, PixelsNearALabelEdgeSayNothing) {
  LabelledPhotos photos(0);
  for (PlaneView& view : photos.views) view.labels.at(40, 35) = kOtherLabel;
  const PlaneDepthResult result = photos.measure();
  EXPECT_EQ(result.views[0].weight.at(40, 35), 0);
  EXPECT_EQ(result.views[0].weight.at(43, 35), 0);
  EXPECT_GT(result.views[0].weight.at(45, 35), 0);
}

TEST(PlaneDepth, AWindowIsInItsWallWhateverItsDepth) {
  LabelledPhotos photos(0);
  PlaneView& view = photos.views[2];
  for (int y = 20; y < 50; ++y) {
    for (int x = 20; x < 60; ++x) {
      view.labels.at(x, y) = kGlassLabel;
      view.depth.at(x, y) *= 1.3f;  // the garden behind it
    }
  }
  const PlaneDepthResult result = photos.measure();
  const PlaneMeasurement& m = result.views[2];
  EXPECT_GT(m.weight.at(40, 35), 0);
  EXPECT_NEAR(view.depth.at(40, 35) * std::exp(m.log_factor.at(40, 35)), photos.truth[2].at(40, 35), 0.02);
}

TEST(PlaneDepth, WithoutLabelsNothingIsDrawnToAPlane) {
  LabelledPhotos photos(0.04);
  for (PlaneView& view : photos.views) view.labels = {};
  const PlaneDepthResult result = photos.measure();
  EXPECT_TRUE(result.planes.empty());
  EXPECT_EQ(result.share, 0);
  for (const PlaneMeasurement& m : result.views)
    EXPECT_EQ(*std::max_element(m.weight.data.begin(), m.weight.data.end()), 0);
}

TEST(PlaneDepth, PhotosWithoutDepthAreLeftOut) {
  LabelledPhotos photos(0.04);
  photos.views[1].depth = ImageF(kWidth, kHeight, 1);
  const PlaneDepthResult result = photos.measure();
  EXPECT_EQ(result.planes.size(), 3u);
  EXPECT_EQ(*std::max_element(result.views[1].weight.data.begin(), result.views[1].weight.data.end()), 0);
}

TEST(PlaneDepth, AHalfSureLabelDrawsHalfAsMuch) {
  LabelledPhotos photos(0);
  const PlaneDepthResult sure = photos.measure();
  photos.views[2].label_share = ImageF(kWidth, kHeight, 1);
  photos.views[2].label_share.data.assign(photos.views[2].label_share.data.size(), 0.5f);
  const PlaneDepthResult half = photos.measure();
  EXPECT_FLOAT_EQ(half.views[2].weight.at(90, 35), 0.5f * sure.views[2].weight.at(90, 35));
  EXPECT_EQ(half.views[1].weight.at(90, 35), sure.views[1].weight.at(90, 35));
}

TEST(PlaneDepth, TablesArePlanesOnlyWhereAskedFor) {
  const LabelSet labels = ade20k_labels();
  const size_t desk = static_cast<size_t>(labels.find("desk"));
  EXPECT_EQ(plane_classes(labels)[desk].kind, PlaneKind::kNone);
  EXPECT_EQ(plane_classes(labels, PlaneSurfaces::kLayoutAndTables)[desk].kind, PlaneKind::kTable);
}

TEST(PlaneDepth, TheRoomsWallsAndFloorAreSquareWhereAskedFor) {
  LabelledPhotos photos(0.04);
  PlaneDepthSettings settings;
  settings.square = true;
  const PlaneDepthResult result = measure_planes(photos.views, kClasses, settings, photos.pool);
  ASSERT_EQ(result.planes.size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(dot(result.planes[i].normal, result.planes[(i + 1) % 3].normal), 0, 1e-9);
}

TEST(PlaneDepth, TheClassesOfAde20kAreKnownByName) {
  const std::vector<PlaneClass> classes = plane_classes(ade20k_labels());
  EXPECT_EQ(classes[0].kind, PlaneKind::kWall);
  EXPECT_EQ(classes[28].kind, PlaneKind::kFloor);  // rug
  EXPECT_TRUE(classes[8].glass);                   // windowpane
  EXPECT_EQ(classes[7].kind, PlaneKind::kNone);    // bed
}

}  // namespace
}  // namespace aligngs
