#include "synth/teacher_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/angles.h"
#include "scene/look_at.h"

namespace aligngs {
namespace {

constexpr int kWide = 96, kHigh = 72;

/// A wall seen face on, of one brightness.
RenderedView wall_at(double metres, float brightness = 0.5f) {
  RenderedView view;
  view.camera.width = kWide;
  view.camera.height = kHigh;
  view.camera.fx = view.camera.fy = 80;
  view.camera.cx = kWide / 2.0;
  view.camera.cy = kHigh / 2.0;
  view.color = ImageF(kWide, kHigh, 3, brightness);
  view.depth = ImageF(kWide, kHigh, 1, static_cast<float>(metres));
  view.normal = ImageF(kWide, kHigh, 3);
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) view.normal.at(x, y, 2) = -1;
  view.labels = Image<uint16_t>(kWide, kHigh, 1);
  view.instances = Image<uint16_t>(kWide, kHigh, 1);
  view.unreliable = Image<uint8_t>(kWide, kHigh, 1);
  return view;
}

TeacherView measured(const RenderedView& view, const DepthSensorSettings& settings = {}) {
  ThreadPool pool(1);
  return simulate_depth_sensor({view}, settings, Random(3), pool).views[0];
}

double share_with_value(const ImageF& map) {
  size_t n = 0;
  for (const float z : map.data) n += z > 0;
  return static_cast<double>(n) / static_cast<double>(map.data.size());
}

TEST(DepthSensor, NoiseGrowsWithTheSquareOfTheDistance) {
  DepthSensorSettings settings;
  settings.wiggle = 0;
  for (const double metres : {1.0, 3.0}) {
    const ImageF depth = measured(wall_at(metres), settings).depth;
    double squares = 0;
    for (const float z : depth.data) squares += (z - metres) * (z - metres);
    const double noise = std::sqrt(squares / static_cast<double>(depth.data.size()));
    EXPECT_NEAR(noise, 0.002 + 0.0012 * metres * metres, 0.2 * (0.002 + 0.0012 * metres * metres)) << metres;
  }
}

TEST(DepthSensor, NothingReturnsFromBeyondTheRange) {
  EXPECT_EQ(share_with_value(measured(wall_at(5)).depth), 0);
  EXPECT_EQ(share_with_value(measured(wall_at(2)).depth), 1);
}

TEST(DepthSensor, GlassLosesMostPixels) {
  RenderedView view = wall_at(2);
  for (uint8_t& u : view.unreliable.data) u = 1;
  EXPECT_NEAR(share_with_value(measured(view).depth), 0.15, 0.02);
}

TEST(DepthSensor, BlackSurfacesLoseMostPixels) {
  EXPECT_NEAR(share_with_value(measured(wall_at(2, 0.1f)).depth), 0.2, 0.02);
}

/// The wall with maps of what it mirrors.
RenderedView mirroring_wall(double metres, float share, double sensed) {
  RenderedView view = wall_at(metres);
  view.mirrored = ImageF(kWide, kHigh, 1, share);
  view.sensed = ImageF(kWide, kHigh, 1, static_cast<float>(sensed));
  return view;
}

TEST(DepthSensor, ASurfaceThatMirrorsMostLightReturnsNothing) {
  EXPECT_EQ(share_with_value(measured(mirroring_wall(2, 0.3f, 2)).depth), 0);
  EXPECT_EQ(share_with_value(measured(mirroring_wall(2, 0.2f, 2)).depth), 1);
}

TEST(DepthSensor, AMirrorHasTheDepthOfTheRoomInIt) {
  const ImageF depth = measured(mirroring_wall(1, 0.92f, 3)).depth;
  double sum = 0;
  for (const float z : depth.data) sum += z / static_cast<double>(depth.data.size());
  EXPECT_NEAR(sum, 3, 0.01);
}

TEST(DepthSensor, NothingReturnsThroughAPane) {
  EXPECT_EQ(share_with_value(measured(mirroring_wall(2, 0.08f, 0)).depth), 0);
}

TEST(DepthSensor, APhotoOfMorePixelsThanTheSensorHasNoiseOfItsPixels) {
  // A quarter of the photo's columns: neighbours share their noise, pixels one of the sensor apart do not.
  DepthSensorSettings settings;
  settings.wiggle = settings.multipath = 0;
  settings.columns = kWide / 4;
  const ImageF depth = measured(wall_at(2), settings).depth;
  const auto correlation = [&](int step) {
    double product = 0, square = 0;
    for (int y = 0; y < kHigh; ++y) {
      for (int x = 0; x + step < kWide; ++x) {
        product += (depth.at(x, y) - 2.0) * (depth.at(x + step, y) - 2.0);
        square += (depth.at(x, y) - 2.0) * (depth.at(x, y) - 2.0);
      }
    }
    return product / square;
  };
  EXPECT_GT(correlation(1), 0.85);
  EXPECT_LT(std::fabs(correlation(12)), 0.2);
}

TEST(DepthSensor, ASurfaceSeenFlatReturnsNothing) {
  RenderedView view = wall_at(2);
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) view.normal.at(x, y, 2) = 0, view.normal.at(x, y, 1) = 1;
  EXPECT_EQ(measured(view).depth.at(kWide / 2, kHigh / 2), 0);
}

TEST(DepthSensor, PixelsFlyBetweenTheDepthsOfAnEdge) {
  RenderedView view = wall_at(1);
  for (int y = 0; y < kHigh; ++y)
    for (int x = kWide / 2; x < kWide; ++x) view.depth.at(x, y) = 2;
  DepthSensorSettings settings;
  settings.noise = settings.noise_growth = settings.wiggle = settings.multipath = 0;
  const TeacherView seen = measured(view, settings);
  const float at_edge = seen.depth.at(kWide / 2 - 1, 10);
  EXPECT_GT(at_edge, 1.05f);
  EXPECT_LT(at_edge, 1.6f);
  EXPECT_EQ(seen.confidence.at(kWide / 2 - 1, 10), 1);
  EXPECT_FLOAT_EQ(seen.depth.at(5, 10), 1);
  EXPECT_EQ(seen.confidence.at(5, 10), 2);
}

TEST(DepthSensor, LightOverAFacingSurfaceComesLate) {
  // A wall face on, and half a metre to the right another one at a right angle.
  RenderedView view = wall_at(2);
  const int corner = kWide / 2 + 20;
  for (int y = 0; y < kHigh; ++y) {
    for (int x = corner; x < kWide; ++x) {
      const Vec3d ray = view.camera.ray(x + 0.5, y + 0.5);
      view.depth.at(x, y) = static_cast<float>(0.5 / ray.x);
      view.normal.at(x, y, 2) = 0;
      view.normal.at(x, y, 0) = -1;
    }
  }
  DepthSensorSettings settings;
  settings.noise = settings.noise_growth = settings.wiggle = 0;
  settings.columns = 1000000;  // no mixing at edges
  const TeacherView seen = measured(view, settings);
  EXPECT_GT(seen.depth.at(corner - 2, 30), 2.0005f);
  EXPECT_NEAR(seen.depth.at(3, 30), 2, 1e-5);
}

TEST(DepthSensor, TheTrackerDriftsByItsSizes) {
  std::vector<RenderedView> views;
  for (int i = 0; i < 400; ++i) {
    RenderedView view = wall_at(2);
    view.camera.world_to_camera.translation = {-0.1 * i, 0, 0};
    views.push_back(std::move(view));
  }
  ThreadPool pool(2);
  const GeometryTeacher phone = simulate_depth_sensor(views, {}, Random(3), pool);
  double turn = 0, shift = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    const Camera &a = phone.views[i].camera, &b = views[i].camera;
    turn += std::pow(rotation_angle_between_degrees(a.world_to_camera.rotation, b.world_to_camera.rotation), 2);
    shift += std::pow(norm(a.centre() - b.centre()), 2);
  }
  EXPECT_NEAR(std::sqrt(turn / 400), 0.35, 0.12);
  EXPECT_NEAR(std::sqrt(shift / 400), 0.010, 0.004);
}

TEST(DepthSensor, AnyNumberOfThreadsGivesTheSameDepth) {
  const std::vector<RenderedView> views = {wall_at(1), wall_at(2), wall_at(3)};
  ThreadPool one(1), three(3);
  const GeometryTeacher a = simulate_depth_sensor(views, {}, Random(3), one),
                        b = simulate_depth_sensor(views, {}, Random(3), three);
  for (size_t i = 0; i < views.size(); ++i) EXPECT_EQ(a.views[i].depth.data, b.views[i].depth.data);
}

}  // namespace
}  // namespace aligngs
