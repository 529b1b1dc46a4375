#include "refine/class_fit.h"

#include <gtest/gtest.h>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint16_t kWallClass = 2, kDoorClass = 5, kLampClass = 9;

/// A camera before the plane z = 2, with 100 columns of pixels: 92 show the wall, 2 a door, 6 nothing labelled.
struct ClassedWall {
  MeasuredView view;
  std::vector<ScenePlane> planes;

  ClassedWall() {
    Camera& camera = view.camera;
    camera.width = 100;
    camera.height = 10;
    camera.fx = camera.fy = 100;
    camera.cx = 50;
    camera.cy = 5;
    view.depth = ImageF(100, 10, 1, 2.0f);
    view.labels = Image<uint16_t>(100, 10, 1, kWallClass);
    for (int y = 0; y < 10; ++y) {
      for (int x = 0; x < 8; ++x) view.labels.at(x, y) = x < 2 ? kDoorClass : kNoLabel;
    }
    ScenePlane plane;
    plane.normal = {0, 0, -1};
    plane.offset = 2;
    planes.push_back(plane);
  }

  std::vector<float> fit() const { return class_fit({view}, planes, {}).front(); }
};

TEST(ClassFit, IsTheShareOnThePlaneAsAPartOfTheUsualOne) {
  const std::vector<float> fit = ClassedWall().fit();
  ASSERT_EQ(fit.size(), kDoorClass + 1u);
  EXPECT_EQ(fit[kWallClass], 1);
  EXPECT_NEAR(fit[kDoorClass], 2.0 / 94 / 0.05, 1e-6);
  EXPECT_EQ(fit[kWallClass + 1], 0);
}

TEST(ClassFit, ThingsBeforeThePlaneAndUnmeasuredOnesDoNotCount) {
  ClassedWall wall;
  for (int y = 0; y < 10; ++y) {
    for (int x = 20; x < 40; ++x) {
      wall.view.labels.at(x, y) = kLampClass;
      wall.view.depth.at(x, y) = x < 30 ? 1.9f : 0;
    }
  }
  EXPECT_EQ(wall.fit().size(), kDoorClass + 1u);
}

TEST(ClassFit, WithoutLabelsThePlaneHasNoList) {
  ClassedWall wall;
  wall.view.labels = {};
  EXPECT_TRUE(wall.fit().empty());
}

TEST(ClassFit, APlaneSeenFromBehindDoesNotCount) {
  ClassedWall wall;
  wall.planes[0].normal = {0, 0, 1};
  wall.planes[0].offset = -2;
  EXPECT_TRUE(wall.fit().empty());
}

}  // namespace
}  // namespace aligngs
