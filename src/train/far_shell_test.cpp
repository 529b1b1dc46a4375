#include "train/far_shell.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/is_depth.h"
#include "scene/look_at.h"
#include "train/start_model.h"

namespace aligngs {
namespace {

constexpr int kImageSide = 60;  // pixels

/// Six views from the middle of a cube of 4 x 4 x 4. The first looks through a window in its wall.
std::vector<TrainingView> cube_views(int window) {
  const Vec3d sides[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<TrainingView> views;
  for (const Vec3d& side : sides) {
    TrainingView view;
    Camera& camera = view.data.camera;
    camera.width = camera.height = kImageSide;
    camera.fx = camera.fy = camera.cx = camera.cy = kImageSide / 2.0;
    camera.world_to_camera = look_at({0, 0, 0}, side, side.z != 0 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
    view.data.color = ImageF(kImageSide, kImageSide, 3, 0.25f);
    view.data.prior_depth = ImageF(kImageSide, kImageSide, 1, 2.0f);
    view.depth_weight = ImageF(kImageSide, kImageSide, 1, 1.0f);
    views.push_back(std::move(view));
  }
  for (int y = (kImageSide - window) / 2; y < (kImageSide + window) / 2; ++y)
    for (int x = (kImageSide - window) / 2; x < (kImageSide + window) / 2; ++x) views[0].data.prior_depth.at(x, y) = 0;
  return views;
}

const std::vector<float> kOnes(6, 1.0f);
constexpr double kCubeExtent = 4;

TEST(FarShell, LiesBehindTheWallOfTheWindow) {
  const std::vector<TrainingView> views = cube_views(20);
  const PointCloud shell = far_shell(views, measured_room(views, kOnes), kCubeExtent, 10000);
  ASSERT_GT(shell.size(), 10u);
  for (size_t i = 0; i < shell.size(); ++i) {
    EXPECT_NEAR(shell.positions[i].x, 2 + 0.05 * kCubeExtent, 0.25);
    EXPECT_LT(std::hypot(shell.positions[i].y, shell.positions[i].z), 1.2);
    EXPECT_FLOAT_EQ(shell.colors[i].y, 0.25f);
    EXPECT_LT(shell.normals[i].x, -0.8f);  // towards the cameras
  }
}

TEST(FarShell, IsEmptyWithoutHoles) {
  const std::vector<TrainingView> views = cube_views(0);
  EXPECT_EQ(far_shell(views, measured_room(views, kOnes), kCubeExtent, 10000).size(), 0u);
}

TEST(FarShell, SmallHolesStayOpen) {
  const std::vector<TrainingView> views = cube_views(4);
  EXPECT_EQ(far_shell(views, measured_room(views, kOnes), kCubeExtent, 10000).size(), 0u);
}

TEST(FarShell, MaskedPixelsAreNoHoles) {
  std::vector<TrainingView> views = cube_views(20);
  views[0].data.mask = ImageF(kImageSide, kImageSide, 1);
  EXPECT_EQ(far_shell(views, measured_room(views, kOnes), kCubeExtent, 10000).size(), 0u);
}

TEST(FarShell, HasAtMostAsManyPointsAsAskedFor) {
  const std::vector<TrainingView> views = cube_views(30);
  const MeasuredHull room = measured_room(views, kOnes);
  const size_t all = far_shell(views, room, kCubeExtent, 10000).size();
  ASSERT_GT(all, 60u);
  EXPECT_LE(far_shell(views, room, kCubeExtent, 50).size(), 50u);
}

TEST(FarShell, FollowsTheScaleOfTheDepth) {
  const std::vector<TrainingView> views = cube_views(20);
  const PointCloud shell = far_shell(views, measured_room(views, std::vector<float>(6, 2.0f)), 2 * kCubeExtent, 10000);
  ASSERT_GT(shell.size(), 10u);
  EXPECT_NEAR(shell.positions[0].x, 4 + 0.1 * kCubeExtent, 0.5);
}

class StartWithShell : public testing::Test {
 protected:
  StartModel start(bool shell, bool sensor) {
    config_.init.start = StartSource::kDepth;
    config_.init.depth_opacity = 0.5;
    config_.init.single_view_opacity = 0.2;
    config_.init.depth_flat_ratio = 0.1;
    config_.init.scale_max = 0.05;
    config_.init.voxel_footprints = 1.2;
    config_.init.far_shell = shell;
    const PointCloud none;
    const StartInputs inputs{config_, views_, kOnes,       none,  PriorDepthKind::kMetric,
                             0,       20000,  kCubeExtent, pool_, sensor};
    return make_start_model(inputs, Random(1));
  }
  TrainConfig config_;
  std::vector<TrainingView> views_ = cube_views(20);
  ThreadPool pool_{2};
};

TEST_F(StartWithShell, ASensorsRoomGetsOneIfAskedFor) {
  const StartModel without = start(false, true), with = start(true, true);
  ASSERT_GT(with.model.size(), without.model.size() + 10);
  EXPECT_TRUE(with.has_normals);
  size_t behind = 0;
  for (size_t i = 0; i < with.model.size(); ++i) behind += with.model.positions[3 * i] > 2.1f;
  EXPECT_EQ(behind, with.model.size() - without.model.size());
}

TEST_F(StartWithShell, DepthOfNetworksGetsNone) {
  EXPECT_EQ(start(true, false).model.size(), start(false, false).model.size());
}

}  // namespace
}  // namespace aligngs
