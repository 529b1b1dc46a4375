#include "scene/measured_hull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/look_at.h"

namespace aligngs {
namespace {

// None of 256 faces is parallel to a side: the body reaches a tenth of the distance behind it.
constexpr double kLoose = 0.25;

/// Six cameras in the middle of a cube of 4 x 4 x 4, each with the depth of one side.
class CubeHull : public testing::Test {
 protected:
  void SetUp() override {
    const Vec3d sides[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const Vec3d& side : sides) {
      Camera camera;
      camera.width = camera.height = 80;
      camera.fx = camera.fy = 40;  // a right angle: the six see everything
      camera.cx = camera.cy = 40;
      camera.world_to_camera = look_at({0, 0, 0}, side, side.z != 0 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
      cameras_.push_back(camera);
      maps_.emplace_back(80, 80, 1, 2.0f);
    }
  }
  MeasuredHull hull() const {
    std::vector<const ImageF*> depths;
    for (const ImageF& map : maps_) depths.push_back(&map);
    return {cameras_, depths};
  }
  std::vector<Camera> cameras_;
  std::vector<ImageF> maps_;
};

TEST_F(CubeHull, RaysLeaveAtTheWalls) {
  EXPECT_NEAR(hull().exit({0, 0, 0}, {1, 0, 0}, 0), 2, kLoose);
  EXPECT_NEAR(hull().exit({0, 1, 0}, {0, 1, 0}, 0), 1, kLoose);
  EXPECT_NEAR(hull().exit({0, 0, 0}, {2, 0, 0}, 0), 1, kLoose / 2);
}

TEST_F(CubeHull, TheMarginLiesBehindTheWalls) {
  EXPECT_NEAR(hull().exit({0, 0, 0}, {1, 0, 0}, 0.3) - hull().exit({0, 0, 0}, {1, 0, 0}, 0), 0.3, 0.01);
}

TEST_F(CubeHull, APointBehindAWallIsOutsideByItsDistance) {
  EXPECT_NEAR(hull().outside({2.5, 0, 0}), 0.5, kLoose);
  EXPECT_LT(hull().outside({1, 0.5, -0.5}), 0);
}

TEST_F(CubeHull, FewPointsBehindAWallDoNotMoveIt) {
  // A mirror of a hundredth of all pixels shows the room behind the wall.
  for (int y = 30; y < 46; ++y)
    for (int x = 30; x < 54; ++x) maps_[0].at(x, y) = 5;
  EXPECT_NEAR(hull().exit({0, 0, 0}, {1, 0, 0}, 0), 2, kLoose);
}

TEST_F(CubeHull, FromOutsideNoRayLeaves) { EXPECT_EQ(hull().exit({3, 0, 0}, {1, 0, 0}, 0), 0); }

TEST_F(CubeHull, CamerasThatSeeOneSideOfARoomAreInsideToo) {
  const MeasuredHull one_side({cameras_[0], cameras_[0]}, {&maps_[0], &maps_[0]});
  ASSERT_FALSE(one_side.empty());
  EXPECT_NEAR(one_side.exit({0, 0, 0}, {1, 0, 0}, 0.1), 2.1, 2 * kLoose);
}

TEST_F(CubeHull, WithoutDepthThereIsNone) {
  for (ImageF& map : maps_) map = ImageF(80, 80, 1);
  EXPECT_TRUE(hull().empty());
  EXPECT_EQ(hull().exit({0, 0, 0}, {1, 0, 0}, 0), 0);
}

}  // namespace
}  // namespace aligngs
