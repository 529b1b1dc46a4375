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

}  // namespace
}  // namespace aligngs
