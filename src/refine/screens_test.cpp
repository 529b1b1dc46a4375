#include "refine/screens.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/screen_room.h"

namespace aligngs {
namespace {

using namespace screen_room;

std::vector<Panel> place(const Photos& photos, std::vector<Panel> panels = {}) {
  ThreadPool pool(2);
  return place_screens(photos.views, photos.luma_pointers(), kScreenClasses, planes(), std::move(panels), {}, pool);
}

/// The panel of a screen that faces the room.
Panel frontal(double z) {
  Panel panel;
  panel.normal = {0, 0, -1};
  panel.offset = z;
  set_upright(panel, planes());
  for (int k = 0; k < 2; ++k) {
    panel.low[k] = -0.6;
    panel.high[k] = 0.6;
  }
  panel.depth = z;
  return panel;
}

TEST(Screens, AHangingOneThatIsTooNearComesBackToItsWall) {
  Photos photos(hanging());
  photos.misjudge(-0.37);
  const std::vector<Panel> panels = place(photos);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].offset, kHanging, 0.02);
  EXPECT_NEAR(panels[0].normal.z, -1, 1e-6);
}

TEST(Screens, AStandingOneComesForwardFromItsWall) {
  Photos photos{Screen{}};
  photos.misjudge(0.37);
  const std::vector<Panel> panels = place(photos);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].offset, kStanding, 0.02);
  EXPECT_NEAR(panels[0].high[0] - panels[0].low[0], 2 * kHalfWidth, 0.05);
  EXPECT_NEAR(panels[0].high[1] - panels[0].low[1], kLowStanding - kHigh, 0.05);
}

TEST(Screens, PhotosThatMisjudgeItInTheirOwnWaysAgreeOnOnePlace) {
  Photos photos{Screen{}};
  photos.misjudge(0.37, {1, -1.5, 0.8, -1, 2});
  const std::vector<Panel> panels = place(photos);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].offset, kStanding, 0.02);
  EXPECT_EQ(panels[0].views, 5);
}

TEST(Screens, OneThatStandsTurnedStaysSo) {
  Screen turned;
  turned.turn = 0.5;
  Photos photos(turned);
  for (PlaneView& view : photos.views) {
    for (size_t p = 0; p < view.depth.data.size(); ++p) {
      if (view.labels.data[p] == kScreenLabel) view.depth.data[p] *= 0.87f;  // a network keeps the direction
    }
  }
  const std::vector<Panel> panels = place(photos);
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(dot(panels[0].normal, turned.normal()), 1, 0.01);
  EXPECT_NEAR(panels[0].distance({0, 0, kStanding}), 0, 0.02);
}

TEST(Screens, ARightOneStays) {
  EXPECT_TRUE(place(Photos{Screen{}}).empty());
  EXPECT_TRUE(place(Photos{hanging()}).empty());
}

TEST(Screens, ARightPanelStays) {
  Photos photos{Screen{}};
  photos.misjudge(0.37);
  const std::vector<Panel> panels = place(photos, {frontal(kStanding)});
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_EQ(panels[0].offset, kStanding);
}

TEST(Screens, AWrongPanelIsReplaced) {
  Photos photos{Screen{}};
  photos.misjudge(0.2);
  const std::vector<Panel> panels = place(photos, {frontal(kStanding - 0.4)});
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].offset, kStanding, 0.02);
}

TEST(Screens, AWrongPanelIsReplacedThoughTheDepthIsRight) {
  // the panel would draw it away
  const std::vector<Panel> panels = place(Photos{Screen{}}, {frontal(kStanding - 0.4)});
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_NEAR(panels[0].offset, kStanding, 0.02);
}

TEST(Screens, OneWithoutEdgesStays) {
  Screen grey;
  Photos photos(grey);
  for (ImageF& luma : photos.lumas) luma = ImageF(kPhotoWidth, kPhotoHeight, 1, 0.5f);
  photos.misjudge(0.37);
  EXPECT_TRUE(place(photos).empty());
}

TEST(Screens, WhatTwoPhotosShowSaysTooLittle) {
  Photos photos(Screen{}, 2);
  photos.misjudge(0.37);
  EXPECT_TRUE(place(photos).empty());
}

TEST(Screens, PhotosFromOnePlaceSayNothing) {
  Photos photos{Screen{}};
  for (size_t v = 1; v < photos.views.size(); ++v) {
    photos.views[v] = photos.views[0];
    photos.lumas[v] = photos.lumas[0];
  }
  photos.misjudge(0.37);
  EXPECT_TRUE(place(photos).empty());
}

TEST(Screens, WithoutLabelsOrPhotosThereAreNone) {
  Photos photos{Screen{}};
  for (PlaneView& view : photos.views) view.labels = {};
  EXPECT_TRUE(place(photos).empty());
  EXPECT_TRUE(place(Photos(Screen{}, 0)).empty());
}

TEST(Screens, TheSameForAnyNumberOfThreads) {
  Photos photos{Screen{}};
  photos.misjudge(0.37);
  ThreadPool one(1), three(3);
  const auto by = [&](ThreadPool& pool) {
    return place_screens(photos.views, photos.luma_pointers(), kScreenClasses, planes(), {}, {}, pool);
  };
  const std::vector<Panel> a = by(one), b = by(three);
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  EXPECT_EQ(a[0].offset, b[0].offset);
  EXPECT_EQ(a[0].low[1], b[0].low[1]);
}

}  // namespace
}  // namespace aligngs
