#include "refine/measured_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

std::vector<MeasuredView> measured_corner(int count) {
  std::vector<MeasuredView> views;
  for (int i = 0; i < count; ++i) {
    RefineView shown = photo(true_camera(i));
    views.push_back({shown.match.camera, std::move(shown.match.depth), ImageF(kWidth, kHeight, 1, 1.0f), {}});
  }
  return views;
}

TEST(MeasuredPlanes, AreThoseOfTheCorner) {
  ThreadPool pool(2);
  const std::vector<ScenePlane> planes = measured_planes(measured_corner(6), {}, pool);
  ASSERT_EQ(planes.size(), 3u);
  for (const Vec3d& place : {Vec3d{0, 0, 3}, Vec3d{1.2, 0, 2}, Vec3d{0, 0.8, 2}}) {
    double nearest = 1;
    for (const ScenePlane& plane : planes) nearest = std::min(nearest, std::abs(plane.distance(place)));
    EXPECT_LT(nearest, 0.005) << place.x << " " << place.y << " " << place.z;
  }
}

TEST(MeasuredPlanes, FaceAlongAxesThatAreKnown) {
  std::vector<MeasuredView> views = measured_corner(6);
  for (MeasuredView& view : views) {  // only the back wall: one plane tells no axes, and noise turns it
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        float& z = view.depth.at(x, y);
        const bool back = view.camera.unproject(x + 0.5, y + 0.5, static_cast<double>(z)).z > 2.999;
        z = back ? z * (1 + 1e-4f * static_cast<float>(x)) : 0;
      }
    }
  }
  MeasuredPlaneSettings settings;
  settings.along_axes.turn_sigma = 1e-3;
  settings.known_axes = RoomAxes{Mat3d::identity(), std::nullopt, 1};
  ThreadPool pool(2);
  const std::vector<ScenePlane> planes = measured_planes(views, settings, pool);
  ASSERT_FALSE(planes.empty());
  EXPECT_NEAR(planes[0].normal.z, -1, 1e-6);
}

TEST(MeasuredPlanes, NothingMeasuredIsNoPlane) {
  std::vector<MeasuredView> views = measured_corner(2);
  std::fill(views[0].depth.data.begin(), views[0].depth.data.end(), 0.0f);
  views[1].depth = views[1].certainty = {};
  ThreadPool pool(1);
  EXPECT_TRUE(measured_planes(views, {}, pool).empty());
}

}  // namespace
}  // namespace aligngs
