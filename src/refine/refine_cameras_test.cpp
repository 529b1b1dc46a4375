#include "refine/refine_cameras.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr double kRoomExtent = 2;  // scene units

std::vector<Camera> cameras_of(const std::vector<RefineView>& views) {
  std::vector<Camera> out;
  for (const RefineView& v : views) out.push_back(v.match.camera);
  return out;
}

std::vector<Camera> cameras_of(const RefineResult& result) {
  std::vector<Camera> out;
  for (const RefinedView& v : result.views) out.push_back(v.camera);
  return out;
}

/// About the vertical.
void turn(Camera& camera, double degrees) {
  const double c = std::cos(degrees * kRadiansPerDegree), s = std::sin(degrees * kRadiansPerDegree);
  camera.world_to_camera = Rigidd{Mat3d{{c, 0, s, 0, 1, 0, -s, 0, c}}, {}} * camera.world_to_camera;
}

/// Photos in which every place is distinct, with true cameras.
std::vector<RefineView> rough_photos(int count) {
  std::vector<RefineView> views;
  for (int i = 0; i < count; ++i) views.push_back(photo(true_camera(i), 0.6));
  return views;
}

/// Small photos need few, and the tests little time.
RefineSettings few_corners() {
  RefineSettings settings;
  settings.tracks.corners.per_view = 800;
  return settings;
}

class RefineCamerasTest : public testing::Test {
 protected:
  ThreadPool pool_{2};
};

TEST_F(RefineCamerasTest, WrongCamerasComeSeveralTimesNearer) {
  const std::vector<RefineView> views = photos(8, 0, 0.6, 0.01);
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  EXPECT_LT(pair_error(cameras_of(result)), 0.3 * pair_error(cameras_of(views)));
  EXPECT_LT(result.bundle.end_median, 0.5);
  EXPECT_GT(result.bundle.start_median, 1);
  EXPECT_GT(result.points.size(), 50u);
}

/// The texture looks alike in many places, so that many matches are wrong.
TEST_F(RefineCamerasTest, CamerasSomeDegreesOffComeHomeAmongWrongMatches) {
  const std::vector<RefineView> views = photos(8, 0, 2, 0.04);
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  EXPECT_LT(pair_error(cameras_of(result)), 0.1 * pair_error(cameras_of(views)));
}

constexpr double kStripe = 0.4;  // scene units

/// A pattern of stripes on the back wall, with a little grain that tells them from each other.
RefineView striped_photo(const Camera& camera) {
  RefineView view = photo(camera);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3d place = camera.unproject(x + 0.5, y + 0.5, view.match.depth.at(x, y));
      const double u = std::sin(2 * kPi * (place.x + place.z) / kStripe), v = std::sin(2 * kPi * place.y / kStripe);
      view.match.luma.at(x, y) = static_cast<float>(0.5 + 0.12 * (u + v) + 0.12 * u * v + 0.2 * grain(place));
    }
  }
  return view;
}

TEST_F(RefineCamerasTest, APatternDoesNotHoldAPhotoOneStripeFurther) {
  constexpr size_t kStrayed = 3;
  constexpr double kShift = 0.6 * kStripe;  // the next stripe is nearer than the right one
  std::vector<RefineView> views;
  for (int i = 0; i < 8; ++i) views.push_back(striped_photo(true_camera(i)));
  Camera& camera = views[kStrayed].match.camera;
  camera.world_to_camera.translation =
      camera.world_to_camera.translation - camera.world_to_camera.rotation * Vec3d{kShift, 0, 0};
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  const Vec3d error = result.views[kStrayed].camera.centre() - true_camera(kStrayed).centre();
  EXPECT_LT(norm(error), 0.1 * kStripe);
}

TEST_F(RefineCamerasTest, NoPhotosGiveNothing) {
  EXPECT_TRUE(refine_cameras({}, kRoomExtent, few_corners(), pool_).views.empty());
}

TEST_F(RefineCamerasTest, AWrongFocalLengthIsFound) {
  std::vector<RefineView> views = photos(8, 0, 0.2, 0.003);
  for (RefineView& v : views) v.match.camera.fx = v.match.camera.fy = 1.03 * kFocal;
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  EXPECT_NEAR(result.views[0].camera.fx, kFocal, 0.012 * kFocal);
}

TEST_F(RefineCamerasTest, TestPhotosAreRegisteredAndMoveNothing) {
  const std::vector<RefineView> with = photos(8, 2, 0.6, 0.01);
  std::vector<RefineView> without = with;
  without.resize(6);
  const RefineResult a = refine_cameras(with, kRoomExtent, few_corners(), pool_),
                     b = refine_cameras(without, kRoomExtent, few_corners(), pool_);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(a.views[i].camera.world_to_camera.translation.x, b.views[i].camera.world_to_camera.translation.x);
  }
  EXPECT_LT(pair_error(cameras_of(a)), 0.6 * pair_error(cameras_of(with)));
  EXPECT_GE(a.views[7].observations, 15);
}

TEST_F(RefineCamerasTest, ATestPhotoFarFromItsPlaceIsLookedForFarther) {
  std::vector<RefineView> views = rough_photos(8);
  views[7].test = true;
  turn(views[7].match.camera, 6);  // 15 pixels; the usual search reaches 8
  RefineSettings settings;
  const RefineResult found = refine_cameras(views, kRoomExtent, settings, pool_);
  EXPECT_FALSE(found.views[7].by_neighbour);
  EXPECT_NEAR(found.views[7].turned, 6, 0.5);
  settings.lost_search = settings.tracks.match.search;
  EXPECT_TRUE(refine_cameras(views, kRoomExtent, settings, pool_).views[7].by_neighbour);
}

TEST_F(RefineCamerasTest, ATrainingPhotoFarFromItsPlaceIsLookedForByTheOthers) {
  std::vector<RefineView> views = rough_photos(8);
  RefineSettings settings;
  const double never_lost = pair_error(cameras_of(refine_cameras(views, kRoomExtent, settings, pool_)));
  turn(views[4].match.camera, 6);
  const RefineResult found = refine_cameras(views, kRoomExtent, settings, pool_);
  EXPECT_FALSE(found.views[4].by_neighbour);
  EXPECT_NEAR(pair_error(cameras_of(found)), never_lost, 0.1 * never_lost);
  EXPECT_GT(found.views[4].observations, 1000);
  for (size_t i = 0; i < 8; ++i) EXPECT_EQ(found.views[i].misplaced, i == 4);
  settings.lost_search = settings.tracks.match.search;
  EXPECT_GT(pair_error(cameras_of(refine_cameras(views, kRoomExtent, settings, pool_))), 2 * never_lost);
}

TEST_F(RefineCamerasTest, ABentDepthIsStraightened) {
  std::vector<RefineView> views = photos(8, 0, 0.1, 0.002);
  ImageF& depth = views[3].match.depth;
  const ImageF truth = depth;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      depth.at(x, y) *= static_cast<float>(1 + 0.05 * (static_cast<double>(x) / kWidth - 0.5));
  }
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  double before = 0, after = 0;
  ImageF corrected = depth;
  result.views[3].depth.apply(corrected);
  for (size_t i = 0; i < truth.data.size(); ++i) {
    before += std::abs(std::log(depth.data[i] / truth.data[i]));
    after += std::abs(std::log(corrected.data[i] / truth.data[i]));
  }
  EXPECT_LT(after, 0.6 * before);
}

TEST_F(RefineCamerasTest, APhotoThatMatchesNothingFollowsItsNeighbour) {
  std::vector<RefineView> views = photos(8, 0, 0.6, 0.01);
  std::fill(views[4].match.luma.data.begin(), views[4].match.luma.data.end(), 0.5f);
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  EXPECT_TRUE(result.views[4].by_neighbour);
  EXPECT_FALSE(result.views[0].by_neighbour);
}

TEST_F(RefineCamerasTest, PhotosWithoutAnythingInCommonKeepTheirCameras) {
  std::vector<RefineView> views = photos(4, 0, 0.6, 0.01);
  for (RefineView& v : views) std::fill(v.match.luma.data.begin(), v.match.luma.data.end(), 0.5f);
  const RefineResult result = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  EXPECT_EQ(result.tracks, 0u);
  for (const RefinedView& v : result.views) EXPECT_LT(v.turned, 1e-5);
}

TEST_F(RefineCamerasTest, AnyNumberOfThreadsGivesTheSame) {
  const std::vector<RefineView> views = photos(5, 1, 0.6, 0.01);
  ThreadPool one(1);
  const RefineResult a = refine_cameras(views, kRoomExtent, few_corners(), one),
                     b = refine_cameras(views, kRoomExtent, few_corners(), pool_);
  for (size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(a.views[i].camera.world_to_camera.translation.z, b.views[i].camera.world_to_camera.translation.z);
  }
}

}  // namespace
}  // namespace aligngs
