#include "refine/sensor_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace aligngs {
namespace {

constexpr int kWide = 80, kHigh = 60;

Camera sensor_camera() {
  Camera camera;
  camera.width = kWide;
  camera.height = kHigh;
  camera.fx = camera.fy = 70;
  camera.cx = kWide / 2.0;
  camera.cy = kHigh / 2.0;
  return camera;
}

/// Depth along z by pixel.
ImageF depth_of(const std::function<double(int x, int y)>& depth) {
  ImageF map(kWide, kHigh, 1);
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) map.at(x, y) = static_cast<float>(depth(x, y));
  return map;
}

SensorDepth cleaned(const ImageF& depth, const ImageF* confidence = nullptr, float luma = 0.5f) {
  return clean_sensor_depth(sensor_camera(), depth, confidence, ImageF(kWide, kHigh, 1, luma), {});
}

/// Depth of the plane through (0, 0, distance) that is turned about the y axis.
double turned_plane(int x, double distance, double degrees) {
  const double u = (x + 0.5 - kWide / 2.0) / 70, t = std::tan(degrees * 3.14159265358979 / 180);
  return distance / (1 - u * t);
}

TEST(SensorDepth, AWallStaysAsItIs) {
  const SensorDepth out = cleaned(depth_of([](int, int) { return 2.0; }));
  EXPECT_EQ(out.mixed, 0);
  EXPECT_EQ(out.doubtful, 0);
  EXPECT_EQ(out.depth.at(40, 30), 2.0f);
  EXPECT_EQ(out.confidence.at(40, 30), 1.0f);
}

TEST(SensorDepth, APixelBetweenTwoSurfacesIsLeftOut) {
  const SensorDepth out = cleaned(depth_of([](int x, int) { return x < 40 ? 1.0 : x == 40 ? 1.5 : 2.0; }));
  EXPECT_EQ(out.depth.at(40, 30), 0);
  EXPECT_EQ(out.confidence.at(40, 30), 0);
  EXPECT_EQ(out.depth.at(39, 30), 1.0f);
  EXPECT_EQ(out.depth.at(41, 30), 2.0f);
  EXPECT_NEAR(out.mixed, 1.0 / kWide, 1e-9);
}

TEST(SensorDepth, PixelsAboveOneAnotherAreComparedToo) {
  const SensorDepth out = cleaned(depth_of([](int, int y) {
    return y < 30 ? 1.0 : y < 32 ? 1.0 + 0.3 * (y - 29) : 2.0;
  }));
  EXPECT_EQ(out.depth.at(10, 30), 0);
  EXPECT_EQ(out.depth.at(10, 31), 0);
  EXPECT_EQ(out.depth.at(10, 29), 1.0f);
}

TEST(SensorDepth, APixelBesideAHoleNeedsOneNeighbour) {
  ImageF depth = depth_of([](int x, int) { return x < 40 ? 1.0 : x == 40 ? 1.5 : 0.0; });
  const SensorDepth out = cleaned(depth);
  EXPECT_EQ(out.depth.at(40, 30), 0);
  EXPECT_EQ(out.depth.at(39, 30), 1.0f);
}

TEST(SensorDepth, TheOnlyPixelOfARowSaysNothingAboutIt) {
  const SensorDepth out = cleaned(depth_of([](int x, int) { return x == 40 ? 1.5 : 0.0; }));
  EXPECT_EQ(out.depth.at(40, 30), 1.5f);
}

TEST(SensorDepth, ASlantedWallIsNoMixture) {
  const SensorDepth out = cleaned(depth_of([](int x, int) { return turned_plane(x, 2, 40); }));
  EXPECT_EQ(out.mixed, 0);
}

TEST(SensorDepth, ASteepWallIsDoubtful) {
  const ImageF steep = depth_of([](int x, int) { return turned_plane(x, 2, 72); }),
               flat = depth_of([](int x, int) { return turned_plane(x, 2, 40); });
  EXPECT_EQ(cleaned(steep).confidence.at(40, 30), 0.5f);
  EXPECT_EQ(cleaned(flat).confidence.at(40, 30), 1.0f);
}

TEST(SensorDepth, BlackIsDoubtful) {
  const ImageF wall = depth_of([](int, int) { return 2.0; });
  EXPECT_EQ(cleaned(wall, nullptr, 0.1f).doubtful, 1);
  EXPECT_EQ(cleaned(wall, nullptr, 0.3f).doubtful, 0);
}

TEST(SensorDepth, LightComesOverTheOtherWallOfACorner) {
  // Two walls that meet at the middle column, each turned by 45 degrees.
  const SensorDepth out =
      cleaned(depth_of([](int x, int) { return x < 40 ? turned_plane(x, 2, 45) : turned_plane(x, 2, -45); }));
  EXPECT_EQ(out.confidence.at(34, 30), 0.5f);
  EXPECT_EQ(out.confidence.at(8, 30), 1.0f);
}

TEST(SensorDepth, TheOuterEdgeOfABoxIsNoCorner) {
  const SensorDepth out =
      cleaned(depth_of([](int x, int) { return x < 40 ? turned_plane(x, 2, -45) : turned_plane(x, 2, 45); }));
  EXPECT_EQ(out.confidence.at(34, 30), 1.0f);
}

TEST(SensorDepth, ConfidenceOfTheSensorIsKept) {
  const ImageF wall = depth_of([](int, int) { return 2.0; }), two(kWide, kHigh, 1, 2.0f);
  EXPECT_EQ(cleaned(wall, &two).confidence.at(5, 5), 2.0f);
  EXPECT_EQ(cleaned(wall, &two, 0.1f).confidence.at(5, 5), 1.0f);
}

}  // namespace
}  // namespace aligngs
