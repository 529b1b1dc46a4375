#include "refine/fused_labels.h"

#include <gtest/gtest.h>

#include "refine/testing/wall_photos.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr uint16_t kPaintedWall = 0, kCurtainLabel = 1, kDoorLabel = 2;
constexpr int kX = 80, kY = 60;  // a pixel of the first photo whose place the others show as well

struct Photos {
  std::vector<PlaneView> views;
  ThreadPool pool{2};

  explicit Photos(int count) {
    for (int i = 0; i < count; ++i) {
      const MatchView exact = photo(true_camera(i)).match;
      Image<uint16_t> labels(kWidth, kHeight, 1);
      labels.data.assign(labels.data.size(), kPaintedWall);
      views.push_back({exact.camera, exact.depth, {}, std::move(labels), {}});
    }
  }
  void call_all_of(size_t view, uint16_t label) {
    views[view].labels.data.assign(views[view].labels.data.size(), label);
  }
  FusedLabels first() { return fuse_labels(views, {}, pool)[0]; }
};

TEST(FusedLabels, APlaceIsCalledWhatMostPhotosCallIt) {
  Photos photos(4);
  photos.call_all_of(0, kCurtainLabel);
  const FusedLabels fused = photos.first();
  EXPECT_EQ(fused.labels.at(kX, kY), kPaintedWall);
  EXPECT_FLOAT_EQ(fused.share.at(kX, kY), 0.75f);
}

TEST(FusedLabels, ThePhotosOwnClassWinsATie) {
  Photos photos(2);
  photos.call_all_of(0, kCurtainLabel);
  EXPECT_EQ(photos.first().labels.at(kX, kY), kCurtainLabel);
}

TEST(FusedLabels, TheSmallestClassWinsATieOfOthers) {
  Photos photos(5);
  photos.call_all_of(0, kCurtainLabel);
  photos.call_all_of(1, kDoorLabel);
  photos.call_all_of(2, kDoorLabel);
  EXPECT_EQ(photos.first().labels.at(kX, kY), kPaintedWall);
}

TEST(FusedLabels, WhatStandsInFrontHasNoVote) {
  Photos photos(3);
  photos.call_all_of(0, kCurtainLabel);
  for (size_t i = 1; i < 3; ++i) {
    for (float& z : photos.views[i].depth.data) z *= 0.8f;
  }
  EXPECT_EQ(photos.first().labels.at(kX, kY), kCurtainLabel);
  EXPECT_FLOAT_EQ(photos.first().share.at(kX, kY), 1.0f);
}

TEST(FusedLabels, APixelThatNobodyNamesHasNoShare) {
  Photos photos(2);
  for (size_t i = 0; i < 2; ++i) photos.call_all_of(i, kNoLabel);
  EXPECT_EQ(photos.first().labels.at(kX, kY), kNoLabel);
  EXPECT_EQ(photos.first().share.at(kX, kY), 0);
}

TEST(FusedLabels, PixelsWithoutDepthKeepTheirOwnAndPhotosWithoutLabelsStayWithout) {
  Photos photos(3);
  photos.call_all_of(0, kCurtainLabel);
  photos.views[0].depth = ImageF(kWidth, kHeight, 1);
  photos.views[2].labels = {};
  const std::vector<FusedLabels> fused = fuse_labels(photos.views, {}, photos.pool);
  EXPECT_EQ(fused[0].labels.at(kX, kY), kCurtainLabel);
  EXPECT_TRUE(fused[2].labels.data.empty());
  EXPECT_TRUE(fuse_labels({}, {}, photos.pool).empty());
}

}  // namespace
}  // namespace aligngs
