#include "scene/import/sensor_cloud.h"

#include <gmock/gmock.h>

#include "scene/camera.h"

namespace aligngs {
namespace {

/// A camera before a wall at a distance of two, whose depth is `times` the distance of the wall's points.
std::string contradiction_at(float times) {
  constexpr int kWidth = 48, kHeight = 36;
  const Camera camera{kWidth, kHeight, 40, 40, 24, 18, {}};
  PointCloud points;
  for (int i = 0; i < 400; ++i) {
    points.positions.push_back({-0.9f + 0.09f * float(i % 20), -0.7f + 0.07f * float(i / 20), 2});
    points.colors.push_back({0.5f, 0.5f, 0.5f});
  }
  SensorCloud sensor;
  sensor.add(camera, ImageF(kWidth, kHeight, 1, 2 * times), Image<uint8_t>(kWidth, kHeight, 3, 90));
  return sensor.contradiction(true, 0.001, points);
}

TEST(SensorCloud, DepthAtTheDistanceOfThePointsAgrees) { EXPECT_EQ(contradiction_at(1), ""); }

TEST(SensorCloud, DepthAtAnotherDistanceThanThePointsIsToldWithItsUnit) {
  EXPECT_THAT(contradiction_at(4),
              testing::AllOf(testing::HasSubstr("depth is 4 times the distance of the points"),
                             testing::HasSubstr("counts as 0.001 here, and seems to mean 0.00025")));
}

TEST(SensorCloud, MetresThatNoRoomHasAreTold) {
  EXPECT_THAT(contradiction_at(1000), testing::HasSubstr("the median depth is 2e+03 m"));
}

TEST(SensorCloud, DepthFarBelowTheDistancesOfTheCamerasIsTold) {
  constexpr int kWidth = 48, kHeight = 36;
  SensorCloud sensor;
  for (int i = 0; i < 4; ++i) {
    Camera camera{kWidth, kHeight, 40, 40, 24, 18, {}};
    camera.world_to_camera.translation = {double(i), 0, 0};
    sensor.add(camera, ImageF(kWidth, kHeight, 1, 0.002f), Image<uint8_t>(kWidth, kHeight, 3, 90));
  }
  EXPECT_THAT(sensor.contradiction(false, 0.001, {}), testing::HasSubstr("% of the cameras' distance"));
}

TEST(SensorCloud, PixelsThatAMaskHidesLeaveNoPoints) {
  constexpr int kWidth = 48, kHeight = 36;
  const Camera camera{kWidth, kHeight, 40, 40, 24, 18, {}};
  Image<uint8_t> photo(kWidth, kHeight, 4, 255);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) photo.at(x, y, 3) = 0;
  }
  SensorCloud sensor;
  sensor.add(camera, ImageF(kWidth, kHeight, 1, 2), photo);
  ThreadPool pool(1);
  const PointCloud cloud = sensor.fuse(0.02, pool);
  EXPECT_FALSE(cloud.positions.empty());
  for (const Vec3f& p : cloud.positions) EXPECT_GE(p.x, 0) << "the left half is hidden";
}

}  // namespace
}  // namespace aligngs
