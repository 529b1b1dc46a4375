#include "refine/view_overlap.h"

#include <gtest/gtest.h>

#include <limits>

namespace aligngs {
namespace {

/// A camera at the origin that looks along z at a wall 2 units away.
struct Wall {
  Camera camera;
  ImageF depth{8, 6, 1};
  Wall() {
    camera.width = 8;
    camera.height = 6;
    camera.fx = camera.fy = 4;
    camera.cx = 4;
    camera.cy = 3;
    depth.data.assign(depth.data.size(), 2.0f);
  }
  std::optional<PixelIndex> showing(const Vec3d& place) const { return pixel_showing(place, camera, depth, 0.05); }
};

TEST(PixelShowing, APlaceOnTheWallIsSeenInItsPixel) {
  const auto pixel = Wall().showing({0.75, -0.25, 2});
  ASSERT_TRUE(pixel);
  EXPECT_EQ(pixel->x, 5);
  EXPECT_EQ(pixel->y, 2);
}

TEST(PixelShowing, PlacesBehindTheWallTheCameraOrBesideTheImageAreNot) {
  const Wall wall;
  EXPECT_FALSE(wall.showing({0, 0, 2.5}));
  EXPECT_FALSE(wall.showing({0, 0, -2}));
  EXPECT_FALSE(wall.showing({3, 0, 2}));
  EXPECT_TRUE(wall.showing({0, 0, 2.05})) << "within 5 %";
}

TEST(PixelShowing, PixelsWithoutDepthShowNothing) {
  Wall wall;
  for (const float none : {0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    wall.depth.data.assign(wall.depth.data.size(), none);
    EXPECT_FALSE(wall.showing({0, 0, 2}));
  }
}

}  // namespace
}  // namespace aligngs
