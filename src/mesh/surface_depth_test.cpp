#include "mesh/surface_depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "mesh/testing/analytic_scenes.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

constexpr Vec3d kHalfRoom{2, 1.3, 2.5};  // of the room, metres; y points down
constexpr uint16_t kWall = 0, kFloor = 1, kCeiling = 2, kChest = 3;

LabelSet labels() {
  LabelSet set;
  for (const char* name : {"wall", "floor", "ceiling", "chest"}) set.classes.push_back({name, {}, {}});
  return set;
}

/// Twelve views of the room, with labels and normals; depth has noise of 1 %.
std::vector<FusionFrame> noisy_room(std::vector<ImageF>& truth) {
  std::vector<FusionFrame> frames = test::room_views(kHalfRoom, 12);
  Random random(3);
  for (FusionFrame& frame : frames) {
    truth.push_back(frame.depth);
    frame.normal = camera_normals(frame.depth, frame.camera);
    frame.label = Image<uint16_t>(frame.camera.width, frame.camera.height, 1, kWall);
    const Rigidd to_world = frame.camera.world_to_camera.inverse();
    for (int y = 0; y < frame.camera.height; ++y) {
      for (int x = 0; x < frame.camera.width; ++x) {
        const Vec3d p = to_world * (frame.camera.ray(x + 0.5, y + 0.5) * double(frame.depth.at(x, y)));
        if (p.y > kHalfRoom.y - 1e-3) frame.label.at(x, y) = kFloor;
        if (p.y < -kHalfRoom.y + 1e-3) frame.label.at(x, y) = kCeiling;
        frame.depth.at(x, y) *= static_cast<float>(std::exp(0.01 * random.normal()));
      }
    }
  }
  return frames;
}

TEST(AgreeingDepth, IsPlaneDepthWhereBothAgreeAndElseMedianDepth) {
  ImageF plane(4, 1, 1), median(4, 1, 1);
  plane.data = {2.01f, 2.2f, 0.0f, 2.0f};
  median.data = {2.0f, 2.0f, 2.0f, 0.0f};
  EXPECT_EQ(agreeing_depth(plane, median, 0.01).data, (std::vector<float>{2.01f, 2.0f, 2.0f, 0.0f}));
}

TEST(ConfirmedDepth, IsPriorDepthWhereRenderedDepthIsNear) {
  ImageF rendered(6, 1, 1), prior(6, 1, 1);
  rendered.data = {2.02f, 1.98f, 2.06f, 2.1f, 2.0f, 0};
  prior.data = {2, 2, 2, 2, 0, 2};
  const ConfirmedDepth confirmed = confirmed_depth(rendered, prior, 0.02);
  EXPECT_FLOAT_EQ(confirmed.depth.data[0], 2) << "1 % off";
  EXPECT_FLOAT_EQ(confirmed.depth.data[1], 2) << "in front";
  EXPECT_NEAR(confirmed.depth.data[2], 2.03, 1e-5) << "3 % off: half of each";
  EXPECT_NEAR(confirmed.share.data[2], 0.5, 1e-4);
  EXPECT_FLOAT_EQ(confirmed.depth.data[3], 2.1f) << "5 % off: another surface";
  EXPECT_FLOAT_EQ(confirmed.depth.data[4], 2) << "no prior";
  EXPECT_EQ(confirmed.share.data[4], 0);
  EXPECT_EQ(confirmed.depth.data[5], 0) << "nothing is rendered";
}

TEST(ConfirmedDepth, ValuesThatAreNoDepthAreNone) {
  const float nan = std::nanf(""), inf = HUGE_VALF;
  ImageF rendered(4, 1, 1), prior(4, 1, 1);
  rendered.data = {2, 2, nan, inf};
  prior.data = {nan, inf, 2, 2};
  const ConfirmedDepth confirmed = confirmed_depth(rendered, prior, 0.02);
  for (const float share : confirmed.share.data) EXPECT_EQ(share, 0);
  EXPECT_EQ(confirmed.depth.data[0], 2);
  EXPECT_EQ(confirmed.depth.data[1], 2);
}

TEST(DrawToStructure, NoisyWallsComeToTheirPlanes) {
  std::vector<ImageF> truth;
  std::vector<FusionFrame> frames = noisy_room(truth);
  ThreadPool pool(2);
  const std::vector<ImageF> drawn = draw_to_structure(frames, labels(), {}, pool);
  double error = 0, count = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    for (size_t p = 0; p < truth[i].data.size(); ++p) {
      if (drawn[i].data[p] < 0.9f) continue;
      error += std::abs(std::log(double(frames[i].depth.data[p]) / truth[i].data[p]));
      ++count;
    }
  }
  EXPECT_GT(count, 0.5 * 12 * 160 * 120) << "most of the room is bare";
  EXPECT_LT(error / count, 0.003) << "of 0.008";
}

TEST(DrawToStructure, WhatHasAnotherNameOrStandsBeforeTheWallStays) {
  std::vector<ImageF> truth;
  std::vector<FusionFrame> frames = noisy_room(truth);
  for (int y = 40; y < 80; ++y) {
    for (int x = 40; x < 80; ++x) frames[0].label.at(x, y) = kChest;
  }
  for (int y = 40; y < 80; ++y) {
    for (int x = 100; x < 140; ++x) frames[0].depth.at(x, y) = 0.9f * truth[0].at(x, y);
  }
  const ImageF before = frames[0].depth;
  ThreadPool pool(2);
  const std::vector<ImageF> drawn = draw_to_structure(frames, labels(), {}, pool);
  for (const int x : {60, 120}) {
    EXPECT_EQ(drawn[0].at(x, 60), 0);
    EXPECT_EQ(frames[0].depth.at(x, 60), before.at(x, 60));
  }
}

TEST(DrawToStructure, WithoutLabelsNothingChanges) {
  std::vector<ImageF> truth;
  std::vector<FusionFrame> frames = noisy_room(truth);
  for (FusionFrame& frame : frames) frame.label = {};
  const ImageF before = frames[0].depth;
  ThreadPool pool(1);
  EXPECT_TRUE(draw_to_structure(frames, labels(), {}, pool)[0].empty());
  EXPECT_EQ(frames[0].depth.data, before.data);
}

}  // namespace
}  // namespace aligngs
