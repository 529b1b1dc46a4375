#include "refine/sensor_cameras.h"

#include <gtest/gtest.h>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr double kWallExtent = 2;  // scene units

SensorCameraSettings quick_settings() {
  SensorCameraSettings settings;
  settings.refine.tracks.corners.per_view = 800;
  return settings;
}

/// Photos in which every place is distinct; cameras wrong by `degrees` and `shift`.
std::vector<RefineView> tracked_photos(int count, int tests, double degrees, double shift) {
  Random random(7);
  std::vector<RefineView> views;
  for (int i = 0; i < count; ++i) {
    views.push_back(photo(true_camera(i), 0.6));
    views.back().match.camera = disturbed(true_camera(i), degrees, shift, random);
    views.back().test = i >= count - tests;
  }
  return views;
}

std::vector<Camera> cameras_of_photos(const std::vector<RefineView>& views) {
  std::vector<Camera> out;
  for (const RefineView& v : views) out.push_back(v.match.camera);
  return out;
}

class SensorCamerasTest : public testing::Test {
 protected:
  SensorCameras check(const std::vector<RefineView>& views, bool correct = true) {
    return check_sensor_cameras(views, kWallExtent, correct, quick_settings(), pool_);
  }
  ThreadPool pool_{2};
};

TEST_F(SensorCamerasTest, TrueCamerasHaveASmallResidualAndStay) {
  const std::vector<RefineView> views = tracked_photos(8, 0, 0, 0);
  const SensorCameras out = check(views);
  EXPECT_LT(out.before, 0.4);
  EXPECT_GT(out.matches, 1000u);
  EXPECT_FALSE(out.corrected);
  EXPECT_EQ(out.cameras[3].world_to_camera.translation.x, views[3].match.camera.world_to_camera.translation.x);
}

TEST_F(SensorCamerasTest, TheResidualIsTheTurnInPixels) {
  // One photo of two turned by a degree: its matches are off by the focal length times that angle.
  std::vector<RefineView> views = tracked_photos(2, 0, 0, 0);
  const double a = kRadiansPerDegree;
  views[1].match.camera.world_to_camera =
      Rigidd{Mat3d{{std::cos(a), 0, -std::sin(a), 0, 1, 0, std::sin(a), 0, std::cos(a)}}, {}} *
      views[1].match.camera.world_to_camera;
  const SensorCameras out = check(views, false);
  EXPECT_NEAR(out.before, kFocal * kRadiansPerDegree, 0.35);
  EXPECT_EQ(out.after, out.before);
}

TEST_F(SensorCamerasTest, CamerasThatAreFourPixelsOffAreCorrected) {
  const std::vector<RefineView> views = tracked_photos(9, 1, 1.1, 0.01);
  const SensorCameras out = check(views);
  EXPECT_GT(out.before, 2.5);
  EXPECT_LT(out.before, 6);
  ASSERT_TRUE(out.corrected);
  EXPECT_LT(out.after, 0.3 * out.before);
  EXPECT_LT(pair_error(out.cameras), 0.3 * pair_error(cameras_of_photos(views)));
}

TEST_F(SensorCamerasTest, NothingMovesWithoutBeingAskedFor) {
  const std::vector<RefineView> views = tracked_photos(8, 0, 1.1, 0.01);
  const SensorCameras out = check(views, false);
  EXPECT_FALSE(out.corrected);
  EXPECT_GT(out.before, 2.5);
  EXPECT_EQ(pair_error(out.cameras), pair_error(cameras_of_photos(views)));
}

/// Photos of which the last shows nothing.
std::vector<RefineView> photos_with_a_blank() {
  std::vector<RefineView> views = tracked_photos(8, 0, 1.1, 0.01);
  std::fill(views[7].match.luma.data.begin(), views[7].match.luma.data.end(), 0.5f);
  return views;
}

TEST_F(SensorCamerasTest, APhotoThatShowsNothingFollowsItsNearNeighbour) {
  const std::vector<RefineView> views = photos_with_a_blank();
  const SensorCameras out = check(views);
  ASSERT_TRUE(out.corrected);
  EXPECT_EQ(out.untrusted, 1);
  const Rigidd relative = out.cameras[7].world_to_camera * out.cameras[6].world_to_camera.inverse(),
               given = views[7].match.camera.world_to_camera * views[6].match.camera.world_to_camera.inverse();
  EXPECT_NEAR(norm(relative.translation - given.translation), 0, 1e-9);
}

TEST_F(SensorCamerasTest, APhotoThatShowsNothingAndIsFarFromOthersKeepsItsCamera) {
  const std::vector<RefineView> views = photos_with_a_blank();
  SensorCameraSettings settings = quick_settings();
  settings.near_distance = 0.01;
  const SensorCameras out = check_sensor_cameras(views, kWallExtent, true, settings, pool_);
  ASSERT_TRUE(out.corrected);
  EXPECT_EQ(out.cameras[7].world_to_camera.translation.x, views[7].match.camera.world_to_camera.translation.x);
}

TEST_F(SensorCamerasTest, APhotoWithFewMatchesIsNotTrusted) {
  SensorCameraSettings settings = quick_settings();
  settings.least_of_photo = 1000000;
  const SensorCameras out = check_sensor_cameras(tracked_photos(6, 0, 1.1, 0.01), kWallExtent, true, settings, pool_);
  EXPECT_EQ(out.untrusted, 6);
  EXPECT_FALSE(out.corrected) << "nothing was gained";
}

TEST_F(SensorCamerasTest, PhotosWithoutMatchesSayNothing) {
  std::vector<RefineView> views = tracked_photos(4, 0, 1.1, 0.01);
  for (RefineView& view : views) std::fill(view.match.luma.data.begin(), view.match.luma.data.end(), 0.5f);
  const SensorCameras out = check(views);
  EXPECT_EQ(out.matches, 0u);
  EXPECT_FALSE(out.corrected);
}

TEST_F(SensorCamerasTest, AnyNumberOfThreadsGivesTheSameCameras) {
  const std::vector<RefineView> views = tracked_photos(6, 1, 1.1, 0.01);
  ThreadPool one(1), three(3);
  const SensorCameras a = check_sensor_cameras(views, kWallExtent, true, quick_settings(), one),
                      b = check_sensor_cameras(views, kWallExtent, true, quick_settings(), three);
  EXPECT_EQ(a.before, b.before);
  EXPECT_EQ(a.after, b.after);
  for (size_t i = 0; i < views.size(); ++i)
    EXPECT_EQ(a.cameras[i].world_to_camera.translation.x, b.cameras[i].world_to_camera.translation.x);
}

}  // namespace
}  // namespace aligngs
