#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/error.h"
#include "scene/look_at.h"
#include "scene/triangle_mesh.h"
#include "synth/depth_jumps.h"
#include "synth/image_degradation.h"
#include "synth/noise.h"
#include "synth/teacher_geometry.h"
#include "synth/teacher_monodepth.h"
#include "synth/teacher_semantic.h"
#include "synth/world_bend.h"

namespace aligngs {
namespace {

double rms(const std::vector<float>& v) {
  double sum = 0;
  for (const float x : v) sum += static_cast<double>(x) * x;
  return std::sqrt(sum / static_cast<double>(v.size()));
}

/// A wall 2.5 m away; the left half is a painting 1.5 m away when `step` is set.
RenderedView flat_view(const Vec3d& eye, bool step) {
  RenderedView v;
  Camera& c = v.camera;
  c.width = 80;
  c.height = 60;
  c.fx = c.fy = 60;
  c.cx = 40;
  c.cy = 30;
  c.world_to_camera = look_at(eye, eye + Vec3d{0, 1, 0}, {0, 0, 1});
  v.depth = ImageF(80, 60, 1, 2.5f);
  v.normal = ImageF(80, 60, 3);
  v.labels = Image<uint16_t>(80, 60, 1, 0);
  v.instances = Image<uint16_t>(80, 60, 1, 0);
  v.unreliable = Image<uint8_t>(80, 60, 1, 0);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      v.normal.at(x, y, 1) = -1;
      if (!step || x >= 40) continue;
      v.depth.at(x, y) = 1.5f;
      v.labels.at(x, y) = 22;
      v.instances.at(x, y) = 1;
    }
  }
  return v;
}

TEST(SmoothRandomMap, HasExactlyTheRequestedRootMeanSquare) {
  Random random(1);
  EXPECT_NEAR(rms(smooth_random_map(64, 48, 4, 3, 0.01, random).data), 0.01, 1e-6);
}

TEST(WorldBend, DisplacesByItsRootMeanSquareAndTurnsByProperRotations) {
  Random random(5);
  const WorldBend bend({0.02, 0, 4.5}, {}, {0, 0, 1}, random);
  double sum = 0;
  Random places(6);
  for (int i = 0; i < 4000; ++i) {
    const Vec3d x{places.uniform(-8, 8), places.uniform(-8, 8), places.uniform(-8, 8)};
    const Vec3d d = bend(x) - x;
    sum += dot(d, d);
  }
  EXPECT_NEAR(std::sqrt(sum / 4000), 0.02, 0.004);
  const Mat3d r = bend.rotation({1, 0.5, 0.3}), should_be_one = r * transpose(r);
  EXPECT_NEAR(determinant(r), 1, 1e-9);
  EXPECT_NEAR(should_be_one(0, 0), 1, 1e-9);
  EXPECT_NEAR(should_be_one(0, 1), 0, 1e-9);
}

TEST(WorldBend, BendsOppositeWallsByTheGivenAngle) {
  Random random(5);
  const WorldBend bend({0, 3, 4}, {}, {0, 0, 1}, random);
  double largest = 0;  // over horizontal directions: the bend's axis is random
  for (int i = 0; i < 180; ++i) {
    const double a = i * 3.14159265358979 / 180;
    const Vec3d d{2 * std::cos(a), 2 * std::sin(a), 0};
    largest = std::max(largest, rotation_angle_between_degrees(bend.rotation(d), bend.rotation(-d)));
  }
  EXPECT_NEAR(largest, 3, 0.05);
}

TEST(WorldBend, WithoutOptionsNothingMoves) {
  const WorldBend bend;
  EXPECT_EQ(norm(bend({1, 2, 3}) - Vec3d{1, 2, 3}), 0);
}

TEST(DepthJumps, AppearAtStepsAndNotOnSlantedPlanes) {
  EXPECT_GT(find_depth_jumps(flat_view({}, true), 3).distance.at(40, 30), 0);
  RenderedView slanted = flat_view({}, false);
  const Vec3d n = normalized(Vec3d{1, -1, 0});  // in the camera frame (x, -z): seen at 45 degrees and less
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      const Vec3d ray = slanted.camera.ray(x + 0.5, y + 0.5);
      const Vec3d world = transpose_times(slanted.camera.world_to_camera.rotation, ray);
      slanted.depth.at(x, y) = static_cast<float>(-2.0 / dot(n, world));
      for (int k = 0; k < 3; ++k) slanted.normal.at(x, y, k) = static_cast<float>(n[k]);
    }
  }
  for (const float d : find_depth_jumps(slanted, 3).distance.data) ASSERT_EQ(d, 0.0f);
}

TEST(DepthJumps, MixingMakesFlyingPixelsBetweenTheTwoDepths) {
  const RenderedView view = flat_view({}, true);
  const ImageF mixed = mix_across_edges(view.depth, find_depth_jumps(view, 4), 2.5);
  EXPECT_GT(mixed.at(39, 30), 1.5f);
  EXPECT_LT(mixed.at(39, 30), 2.0f);
  EXPECT_LT(mixed.at(40, 30), 2.5f);
  EXPECT_GT(mixed.at(40, 30), 2.0f);
  EXPECT_EQ(mixed.at(10, 30), 1.5f);
}

std::vector<RenderedView> row_of_views(int n) {
  std::vector<RenderedView> views;
  for (int i = 0; i < n; ++i) views.push_back(flat_view({0.3 * i, 0, 1.4}, true));
  return views;
}

TEST(ExposureWalk, NeighboursAreAlikeAndNoneIsBeyondAFactorOfTwo) {
  double step = 0, spread = 0;
  constexpr int kPhotos = 200;
  for (int i = 0; i < kPhotos; ++i) {
    const std::array<double, 3> here = exposure_walk(Random(7), i), next = exposure_walk(Random(7), i + 1);
    step += std::pow(next[1] - here[1], 2);
    spread += std::pow(here[1], 2);
    for (const double gain : here) EXPECT_LE(std::fabs(gain), std::log(2.0));
  }
  EXPECT_LT(step, 0.6 * spread);
  EXPECT_NEAR(std::sqrt(spread / kPhotos), 0.35, 0.12);
}

TEST(GeometryTeacher, DisturbsCamerasAndDepthByTheirSizes) {
  const std::vector<RenderedView> views = row_of_views(30);
  ThreadPool pool(2);
  GeometryTeacherSettings s = geometry_teacher_settings(TeacherLevel::kMedium);
  // residuals alone
  s.bend_rms = s.bend_degrees = s.outlier_share = s.shared_focal = s.failure_share = s.shared_failure_share = 0;
  const GeometryTeacher t = simulate_geometry_teacher(views, s, {}, 4, {0, 0, 1}, Random(3), pool);
  double turn = 0, shift = 0, error = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    const Camera &a = t.views[i].camera, &b = views[i].camera;
    turn += std::pow(rotation_angle_between_degrees(a.world_to_camera.rotation, b.world_to_camera.rotation), 2);
    shift += std::pow(norm(a.centre() - b.centre()), 2);
    std::vector<float> relative;
    for (int y = 0; y < 60; ++y) relative.push_back(t.views[i].depth.at(5, y) / 1.5f - 1);
    error += std::pow(rms(relative), 2);
  }
  EXPECT_NEAR(std::sqrt(turn / 30), 0.25, 0.1);
  EXPECT_NEAR(std::sqrt(shift / 30), 0.008, 0.003);
  EXPECT_NEAR(std::sqrt(error / 30), 0.0118, 0.004);  // scale and warp of 0.8 %, noise of 0.3 %
}

TEST(GeometryTeacher, WeakerNetworksKeepThePublishedRatiosToVggt) {
  const GeometryTeacherSettings medium = geometry_teacher_settings(TeacherLevel::kMedium),
                                base = geometry_teacher_settings(TeacherLevel::kBase),
                                small = geometry_teacher_settings(TeacherLevel::kSmall);
  EXPECT_NEAR(base.rotation_degrees / medium.rotation_degrees, 0.434 / 0.300, 1e-9);  // 1 - AUC
  EXPECT_NEAR(small.bend_rms / medium.bend_rms, 0.524 / 0.300, 1e-9);
  EXPECT_NEAR(base.warp_rms / medium.warp_rms, 0.159 / 0.105, 1e-9);  // AbsRel
  EXPECT_NEAR(small.warp_rms / medium.warp_rms, 0.191 / 0.105, 1e-9);
}

TEST(TeacherLevel, EveryNameIsRead) {
  for (const TeacherLevel level : kTeacherLevels) EXPECT_EQ(parse_teacher_level(teacher_level_name(level)), level);
  EXPECT_THROW(parse_teacher_level("tiny"), Error);
}

TEST(GeometryTeacher, OutliersAreAsManyAsTheShareSays) {
  ThreadPool pool(2);
  GeometryTeacherSettings s = geometry_teacher_settings(TeacherLevel::kHigh);
  s.outlier_share = 0.2;
  const std::vector<RenderedView> views = row_of_views(20);
  const GeometryTeacher t = simulate_geometry_teacher(views, s, {}, 4, {0, 0, 1}, Random(3), pool);
  int outliers = 0;
  for (const TeacherView& v : t.views) outliers += v.outlier;
  EXPECT_EQ(outliers, 4);
}

TEST(GeometryTeacher, ConfidenceDoesNotKnowTheBend) {
  // With the bend alone the view's own error is zero everywhere, however wrong the depth.
  ThreadPool pool(1);
  GeometryTeacherSettings s;
  s.rotation_degrees = s.translation = s.outlier_share = s.shared_focal = s.view_focal = 0;
  s.view_scale = s.warp_rms = s.white = s.patch = s.failure_share = s.shared_failure_share = 0;
  s.bend_rms = 0.05;
  const GeometryTeacher t =
      simulate_geometry_teacher({flat_view({}, false)}, s, {0, 1, 0}, 4, {0, 0, 1}, Random(3), pool);
  std::vector<float> relative;
  for (const float z : t.views[0].depth.data) relative.push_back(z / 2.5f - 1);
  EXPECT_GT(rms(relative), 0.002);
  EXPECT_LT(rms(t.views[0].own_error.data), 1e-6);
}

TEST(GeometryTeacher, AnUnknownSimilarityScalesDepthAndCamerasAlike) {
  ThreadPool pool(1);
  GeometryTeacherSettings s = geometry_teacher_settings(TeacherLevel::kLow);
  const std::vector<RenderedView> views = row_of_views(4);
  const GeometryTeacher metric = simulate_geometry_teacher(views, s, {}, 4, {0, 0, 1}, Random(3), pool);
  s.similarity = true;
  const GeometryTeacher unit = simulate_geometry_teacher(views, s, {}, 4, {0, 0, 1}, Random(3), pool);
  const auto unproject = [](const TeacherView& v) { return v.camera.unproject(10.5, 20.5, v.depth.at(10, 20)); };
  EXPECT_LT(norm(unit.world * unproject(metric.views[2]) - unproject(unit.views[2])), 1e-5);
  EXPECT_NE(unit.world.scale, 1);
}

TEST(MonoDepth, ErrsPerViewButKeepsTheShape) {
  const RenderedView view = flat_view({}, true);
  const ImageF a = simulate_mono_depth(view, 0, mono_depth_settings(TeacherLevel::kMedium), Random(2));
  const ImageF b = simulate_mono_depth(view, 1, mono_depth_settings(TeacherLevel::kMedium), Random(2));
  EXPECT_NE(a.at(70, 30), b.at(70, 30));
  for (const ImageF* d : {&a, &b}) {
    EXPECT_NEAR(d->at(70, 30), 2.5, 0.9);
    EXPECT_LT(d->at(10, 30), d->at(70, 30));
  }
}

TEST(SemanticTeacher, ExactScoresGiveTheLabelsBack) {
  ThreadPool pool(1);
  const std::vector<RenderedView> views = {flat_view({}, true)};
  const ScoreMap s = exact_semantic_teacher(views, 0.5, pool)[0];
  EXPECT_EQ(s.width, 40);
  EXPECT_EQ(s.channels, 150);
  EXPECT_NEAR(s.score(22, 5, 10), 0.97f, 1e-3);
  const Image<uint16_t> labels = semantic_labels(s, 80, 60);
  for (size_t i = 0; i < labels.data.size(); ++i) ASSERT_EQ(labels.data[i], views[0].labels.data[i]);
}

TEST(SemanticTeacher, ConfusedObjectsAreConfusedInMostOfTheirViews) {
  ThreadPool pool(2);
  RoomModel room;
  room.objects = {{0, "wall"}, {22, "painting"}};
  SemanticTeacherSettings s;
  s.confused_share = 1;
  s.dropped = s.dropped_small = s.duplicate = s.flip = 0;
  const std::vector<ScoreMap> scores = simulate_semantic_teacher(row_of_views(20), room, s, 0.5, Random(4), pool);
  int wrong = 0;
  for (const ScoreMap& v : scores) {
    for (const uint16_t half : v.values) ASSERT_LE(half, 0x3c00);  // at most 1
    wrong += semantic_labels(v, 80, 60).at(10, 30) != 22;
    EXPECT_EQ(semantic_labels(v, 80, 60).at(70, 30), 0);  // walls are right
  }
  EXPECT_GE(wrong, 14);
}

TEST(SemanticTeacher, NothingInViewGivesNoScores) {
  ThreadPool pool(1);
  RenderedView empty = flat_view({}, false);
  std::fill(empty.labels.data.begin(), empty.labels.data.end(), kNoLabel);
  std::fill(empty.instances.data.begin(), empty.instances.data.end(), uint16_t(65535));
  RoomModel room;
  room.objects = {{0, "wall"}};
  const ScoreMap s = simulate_semantic_teacher({empty}, room, {}, 0.5, Random(4), pool)[0];
  EXPECT_EQ(semantic_labels(s, 80, 60).at(3, 3), kNoLabel);
}

TEST(ImageDegradation, IsSeededAndStaysNearThePicture) {
  ImageF grey(64, 48, 3, 0.5f);
  const Image<uint8_t> a = degrade_image(grey, {}, Random(1)), b = degrade_image(grey, {}, Random(1));
  EXPECT_EQ(a.data, b.data);
  EXPECT_NE(a.data, degrade_image(grey, {}, Random(2)).data);
  const double mean = std::accumulate(a.data.begin(), a.data.end(), 0.0) / static_cast<double>(a.data.size());
  EXPECT_NEAR(mean, 127.5, 12);  // 12 % of linear light are about 6 % here
}

}  // namespace
}  // namespace aligngs
