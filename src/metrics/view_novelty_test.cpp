#include "metrics/view_novelty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

/// At (x, 0, 0), turned by `degrees` about the y axis.
Camera camera_turned(double x, double degrees) {
  const double a = degrees * 3.14159265358979323846 / 180;
  Camera camera;
  camera.world_to_camera.rotation = Mat3d{{std::cos(a), 0, -std::sin(a), 0, 1, 0, std::sin(a), 0, std::cos(a)}};
  camera.world_to_camera.translation = -(camera.world_to_camera.rotation * Vec3d{x, 0, 0});
  return camera;
}

TEST(ViewNovelty, MeasuresToTheNearestTrainingView) {
  const ViewNovelty n = view_novelty(camera_turned(1.2, 20), {camera_turned(0, 0), camera_turned(1, 50)});
  EXPECT_NEAR(n.distance, 0.2, 1e-9);
  EXPECT_NEAR(n.degrees, 20, 1e-6);
  EXPECT_FALSE(extrapolates(n, 1));
}

TEST(ViewNovelty, FarOrTurnedViewsExtrapolate) {
  EXPECT_TRUE(extrapolates(view_novelty(camera_turned(0.6, 0), {camera_turned(0, 0)}), 1));
  EXPECT_TRUE(extrapolates(view_novelty(camera_turned(0, 40), {camera_turned(0, 0)}), 1));
  EXPECT_FALSE(extrapolates(view_novelty(camera_turned(0.6, 0), {camera_turned(0, 0)}), 0.5))
      << "half a metre per unit";
}

TEST(ViewNovelty, WithoutTrainingViewsEverythingExtrapolates) {
  EXPECT_TRUE(extrapolates(view_novelty(camera_turned(0, 0), {}), 1));
}

}  // namespace
}  // namespace aligngs
