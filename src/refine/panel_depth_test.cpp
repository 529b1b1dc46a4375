#include "refine/panel_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr int kPanelWidth = 120, kPanelHeight = 90;
constexpr uint16_t kWall = 0, kPane = 1;
constexpr double kWallDepth = 3, kPaneDepth = 3.1, kBehind = 3.9;  // metres; what a network sees of the garden
const std::vector<PanelClass> kPanelClasses = {PanelClass::kNone, PanelClass::kInWall};

ScenePlane wall() {
  ScenePlane p;
  p.normal = {0, 0, -1};
  p.offset = kWallDepth;
  p.kind = PlaneKind::kWall;
  return p;
}

/// Photos of a wall with a window whose frame, 12 cm, is measured, and whose glass is not.
struct WindowPhotos {
  std::vector<PlaneView> views;
  std::vector<PlaneMeasurement> measurements;
  ThreadPool pool{2};

  explicit WindowPhotos(int count = 3) {
    for (int i = 0; i < count; ++i) {
      PlaneView view;
      view.camera.width = kPanelWidth;
      view.camera.height = kPanelHeight;
      view.camera.fx = view.camera.fy = 100;
      view.camera.cx = kPanelWidth / 2.0;
      view.camera.cy = kPanelHeight / 2.0;
      view.camera.world_to_camera.translation = {-0.1 * i, 0, 0};
      view.depth = ImageF(kPanelWidth, kPanelHeight, 1);
      view.certainty = ImageF(kPanelWidth, kPanelHeight, 1);
      view.labels = Image<uint16_t>(kPanelWidth, kPanelHeight, 1);
      for (int y = 0; y < kPanelHeight; ++y) {
        for (int x = 0; x < kPanelWidth; ++x) paint(view, x, y);
      }
      views.push_back(std::move(view));
      measurements.push_back({ImageF(kPanelWidth, kPanelHeight, 1), ImageF(kPanelWidth, kPanelHeight, 1),
                              Image<uint8_t>(kPanelWidth, kPanelHeight, 1)});
    }
  }

  static void paint(PlaneView& view, int x, int y) {
    const Vec3d at = view.camera.unproject(x + 0.5, y + 0.5, kPaneDepth);
    const double inside = std::min(0.8 - std::abs(at.x), 0.7 - std::abs(at.y));  // of the window's outline
    const bool pane = inside > 0, glass = inside > 0.25;
    view.labels.at(x, y) = pane ? kPane : kWall;
    view.depth.at(x, y) = static_cast<float>(glass ? kBehind : pane ? kPaneDepth : kWallDepth);
    view.certainty.at(x, y) = glass ? 0.0f : 0.6f;
  }

  std::vector<Panel> find() const { return find_panels(views, kPanelClasses, {wall()}, {}); }
  void measure() { measure_on_panels(find(), {wall()}, views, kPanelClasses, {}, pool, measurements); }
};

TEST(PanelDepth, GlassLiesInThePlaneOfItsFrame) {
  WindowPhotos photos;
  photos.measure();
  for (size_t v = 0; v < photos.views.size(); ++v) {
    const PlaneMeasurement& m = photos.measurements[v];
    const int x = kPanelWidth / 2, y = kPanelHeight / 2;
    EXPECT_GT(m.weight.at(x, y), 0);
    EXPECT_NEAR(photos.views[v].depth.at(x, y) * std::exp(m.log_factor.at(x, y)), kPaneDepth, 0.01);
  }
}

TEST(PanelDepth, TheWallAroundItIsNotTouched) {
  WindowPhotos photos;
  photos.measurements[0].weight.at(2, 2) = 5;
  photos.measure();
  EXPECT_EQ(photos.measurements[0].weight.at(2, 2), 5);
}

TEST(PanelDepth, WhatIsMeasuredBeforeThePaneKeepsItsDepth) {
  WindowPhotos photos;
  const int x = kPanelWidth / 2, y = kPanelHeight / 2;
  photos.views[0].depth.at(x, y) = 2.5f;  // a lamp that the teacher takes for the pane
  photos.views[0].certainty.at(x, y) = 0.8f;
  photos.measure();
  EXPECT_EQ(photos.measurements[0].weight.at(x, y), 0);
  EXPECT_GT(photos.measurements[0].weight.at(x + 1, y), 0);
}

TEST(PanelDepth, CurtainsThatTheTeacherCallsAPaneAreNone) {
  WindowPhotos photos;
  for (PlaneView& view : photos.views) {
    for (float& z : view.depth.data) {
      // all of it hangs before the wall
      if (z != static_cast<float>(kWallDepth)) z = z == static_cast<float>(kBehind) ? 2.9f : 2.7f;
    }
  }
  EXPECT_TRUE(photos.find().empty());
  // a mirror or screen may
  EXPECT_FALSE(find_panels(photos.views, {PanelClass::kNone, PanelClass::kFree}, {wall()}, {}).empty());
}

TEST(PanelDepth, APhotoThatMeasuredNothingTakesThePaneOfTheOthers) {
  WindowPhotos photos(4);
  photos.views[3].certainty = ImageF(kPanelWidth, kPanelHeight, 1);
  photos.measure();
  EXPECT_NEAR(photos.views[3].depth.at(60, 45) * std::exp(photos.measurements[3].log_factor.at(60, 45)), kPaneDepth,
              0.01);
}

TEST(PanelDepth, APaneOfWhichNothingIsMeasuredIsInItsWallAtTheFarthest) {
  WindowPhotos photos;
  for (PlaneView& view : photos.views) {
    for (size_t p = 0; p < view.certainty.data.size(); ++p) view.certainty.data[p] = 0;
  }
  photos.views[1].depth.at(60, 45) = 2.5f;
  photos.measure();
  EXPECT_NEAR(photos.views[0].depth.at(60, 45) * std::exp(photos.measurements[0].log_factor.at(60, 45)), kWallDepth,
              0.01);
  EXPECT_EQ(photos.measurements[1].weight.at(60, 45), 0);  // a picture may lean at something before the wall
}

TEST(PanelDepth, AMirageBeyondReachIsLeftAlone) {
  WindowPhotos photos;
  photos.views[0].depth.at(60, 45) = 30;
  photos.measure();
  EXPECT_EQ(photos.measurements[0].weight.at(60, 45), 0);
}

TEST(PanelDepth, AHalfSureLabelDrawsHalfAsMuch) {
  WindowPhotos photos;
  photos.views[0].label_share = ImageF(kPanelWidth, kPanelHeight, 1);
  std::fill(photos.views[0].label_share.data.begin(), photos.views[0].label_share.data.end(), 0.5f);
  photos.measure();
  EXPECT_FLOAT_EQ(photos.measurements[0].weight.at(60, 45), 0.5f * photos.measurements[1].weight.at(60, 45));
}

TEST(PanelDepth, WithoutMeasurementsOrLabelsThereAreNoPanels) {
  WindowPhotos photos;
  for (PlaneView& view : photos.views) view.certainty = ImageF(kPanelWidth, kPanelHeight, 1);
  EXPECT_TRUE(photos.find().empty());
  for (PlaneView& view : photos.views) view.labels = {};
  photos.measure();
  EXPECT_EQ(*std::max_element(photos.measurements[0].weight.data.begin(), photos.measurements[0].weight.data.end()), 0);
}

TEST(PanelDepth, PanesMirrorsScreensAndPicturesAreTheClasses) {
  const LabelSet labels = ade20k_labels();
  const std::vector<PanelClass> classes = panel_classes(labels);
  const auto of = [&](const char* name) { return classes[static_cast<size_t>(labels.find(name))]; };
  for (const char* name : {"windowpane", "painting", "blind"}) EXPECT_EQ(of(name), PanelClass::kInWall) << name;
  EXPECT_EQ(of("mirror"), PanelClass::kFree);
  for (const char* name : {"television", "monitor", "crt screen"}) EXPECT_EQ(of(name), PanelClass::kScreen) << name;
  for (const char* name : {"wall", "curtain", "door"}) EXPECT_EQ(of(name), PanelClass::kNone) << name;
}

}  // namespace
}  // namespace aligngs
