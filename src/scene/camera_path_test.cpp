#include "scene/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

CameraKey key(double time, double x, double fov = 60) { return {time, {x, 0, 1}, {x, 5, 1}, fov}; }

TEST(CameraPath, PassesThroughItsKeysAndHoldsOutside) {
  const CameraPath path{{key(1, 0), key(2, 3), key(5, 4, 40)}};
  EXPECT_DOUBLE_EQ(path.duration(), 4);
  for (const CameraKey& k : path.keys) EXPECT_NEAR(key_at(path, k.time).eye.x, k.eye.x, 1e-12);
  EXPECT_DOUBLE_EQ(key_at(path, 0).eye.x, 0);
  EXPECT_DOUBLE_EQ(key_at(path, 9).fov, 40);
}

TEST(CameraPath, GoesEvenlyAlongALine) {
  const CameraPath path{{key(0, 0), key(1, 2), key(4, 8)}};
  for (const double t : {0.3, 0.9, 1.5, 3.7}) EXPECT_NEAR(key_at(path, t).eye.x, 2 * t, 1e-12) << t;
}

TEST(CameraPath, HasNoCornerAtAKeyNorWhereALoopCloses) {
  CameraPath loop;
  for (int i = 0; i <= 8; ++i)
    loop.keys.push_back({double(i), {std::cos(i * M_PI / 4), std::sin(i * M_PI / 4), 0}, {0, 0, 0}, 60});
  loop.keys.back().eye = loop.keys.front().eye;
  const double h = 1e-5;
  const auto speed = [&](double t) { return (key_at(loop, t + h).eye - key_at(loop, t).eye) * (1 / h); };
  EXPECT_LT(norm(speed(3 - h) - speed(3)), 1e-3);
  EXPECT_LT(norm(speed(8 - h) - speed(0)), 1e-3);
}

TEST(CameraPath, IsStretchedToATime) {
  const CameraPath path = stretched({{key(1, 0), key(2, 3), key(5, 4)}}, 8);
  EXPECT_DOUBLE_EQ(path.duration(), 8);
  EXPECT_DOUBLE_EQ(path.keys[1].time, 3);
}

TEST(CameraPath, CameraSeesTheTargetInTheMiddleAndTheFieldOfView) {
  const Camera camera = camera_of({0, {1, 2, 3}, {4, 2, 3}, 90}, {0, 0, 1}, 640, 480);
  const Vec2d middle = camera.project(camera.world_to_camera * Vec3d{4, 2, 3}),
              top = camera.project(camera.world_to_camera * Vec3d{2, 2, 4});
  EXPECT_NEAR(middle.x, 320, 1e-9);
  EXPECT_NEAR(middle.y, 240, 1e-9);
  EXPECT_NEAR(top.y, 0, 1e-9);
}

TEST(CameraPath, CameraMayLookStraightDown) {
  const Camera camera = camera_of({0, {0, 0, 3}, {0, 0, 0}, 60}, {0, 0, 1}, 100, 100);
  EXPECT_NEAR(norm(camera.forward() - Vec3d{0, 0, -1}), 0, 1e-12);
  EXPECT_NEAR(determinant(camera.world_to_camera.rotation), 1, 1e-12);
}

}  // namespace
}  // namespace aligngs
