#include "refine/unseen_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "refine/testing/box_room.h"

namespace aligngs {
namespace {

using namespace box_room;

UnseenLayout unseen(const std::vector<LayoutView>& views, int threads = 2) {
  ThreadPool pool(threads);
  LayoutSettings settings;
  settings.cell = 0.05;
  return unseen_layout(views, kClasses, settings, pool);
}

/// Whether a photo shows the very place; its surroundings, half a square, do not count.
bool is_seen(const Vec3d& x) {
  for (const Camera& c : cameras()) {
    const Vec3d p = c.world_to_camera * x;
    if (p.z <= 0 || !c.contains(c.project(p))) continue;
    const Vec3d ray = (x - c.centre()) * (1 / p.z);
    if (trace(c.centre(), ray).t > p.z * 0.97) return true;
  }
  return false;
}

template <class Predicate>
size_t count(const UnseenLayout& layout, Predicate&& predicate) {
  size_t n = 0;
  for (const Vec3f& p : layout.cloud.positions) n += predicate(p.cast<double>()) ? 1 : 0;
  return n;
}

TEST(UnseenLayout, LiesOnThePlanesOfTheRoomWhereNoPhotoLooks) {
  const UnseenLayout layout = unseen(photos());
  ASSERT_GT(layout.cloud.size(), 500u);
  for (const Vec3f& point : layout.cloud.positions) {
    const Vec3d p = point.cast<double>();
    const double nearest = std::min(
        {std::abs(p.y - kFloor), std::abs(p.y - kCeiling), std::abs(std::abs(p.x) - kSide), std::abs(p.z - kEnd)});
    EXPECT_LT(nearest, 0.02) << p.x << ' ' << p.y << ' ' << p.z;
  }
  const size_t seen = count(layout, is_seen);
  EXPECT_LT(seen, layout.cloud.size() / 50);  // squares whose centre lies a pixel from an edge
}

TEST(UnseenLayout, GoesOnBehindFurnitureAndBesideThePhotos) {
  const UnseenLayout layout = unseen(photos());
  const auto on_floor = [](const Vec3d& p) { return std::abs(p.y - kFloor) < 0.02; };
  EXPECT_GT(count(layout,
                  [&](const Vec3d& p) {
                    return on_floor(p) && p.x > kChestLow.x && p.x < kChestHigh.x && p.z > kChestLow.z &&
                           p.z < kChestHigh.z;
                  }),
            50u);
  EXPECT_GT(count(layout, [&](const Vec3d& p) { return on_floor(p) && p.z < -0.8; }), 500u);
}

TEST(UnseenLayout, StaysInsideOfTheOtherPlanes) {
  const UnseenLayout layout = unseen(photos());
  EXPECT_EQ(count(layout,
                  [](const Vec3d& p) {
                    return p.x > kSide + 0.06 || p.x < -kSide - 0.06 || p.y > kFloor + 0.06 || p.z > kEnd + 0.06;
                  }),
            0u);
}

TEST(UnseenLayout, ADoorwayStaysOpen) {
  const UnseenLayout layout = unseen(photos());
  EXPECT_EQ(count(layout, [](const Vec3d& p) { return std::abs(p.x - kSide) < 0.1 && in_doorway(p.y, p.z); }), 0u);
}

TEST(UnseenLayout, APaneInItsNicheIsNotWalledUp) {
  // Between what counts as the wall's own surface (3 % of the depth) and what counts as seen through it (5 %).
  const auto in_pane = [](const Vec3d& p) {
    return p.z > kEnd - 0.1 && std::abs(p.x) < 1.2 && p.y > -0.9 && p.y < 0.5;
  };
  std::vector<LayoutView> views = photos();
  size_t moved = 0;
  for (LayoutView& view : views) {
    for (int y = 0; y < view.plane.camera.height; ++y) {
      for (int x = 0; x < view.plane.camera.width; ++x) {
        float& z = view.plane.depth.at(x, y);
        if (!in_pane(view.plane.camera.unproject(x + 0.5, y + 0.5, z))) continue;
        z *= 1.04f;
        ++moved;
      }
    }
  }
  ASSERT_GT(moved, 500u);
  EXPECT_EQ(count(unseen(views), in_pane), count(unseen(photos()), in_pane));
}

TEST(UnseenLayout, HasTheColourAndClassOfItsPlaneAndFacesTheRoom) {
  const UnseenLayout layout = unseen(photos());
  size_t floor = 0;
  for (size_t i = 0; i < layout.cloud.size(); ++i) {
    if (layout.labels[i] != kFloorLabel) continue;
    ++floor;
    EXPECT_NEAR(layout.cloud.positions[i].y, kFloor, 0.02);
    EXPECT_LT(layout.cloud.normals[i].y, -0.99f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(layout.cloud.colors[i][c], kColors[kFloorLabel][c], 0.05f);
  }
  EXPECT_GT(floor, 300u);
}

TEST(UnseenLayout, APartitionIsNotExtended) {
  std::vector<LayoutView> views = photos();
  // A free-standing wall at z = 1.8 on the left, through none of which photos look, with much of the room behind its
  // plane.
  for (LayoutView& view : views) {
    const Mat3d to_world = transpose(view.plane.camera.world_to_camera.rotation);
    const Vec3d centre = view.plane.camera.centre();
    for (int y = 0; y < view.plane.depth.height; ++y) {
      for (int x = 0; x < view.plane.depth.width; ++x) {
        const Vec3d ray = to_world * view.plane.camera.ray(x + 0.5, y + 0.5);
        const double t = (1.8 - centre.z) / ray.z;
        if (t <= 0 || t >= view.plane.depth.at(x, y) || centre.x + t * ray.x > -0.9) continue;
        view.plane.depth.at(x, y) = static_cast<float>(t);
        view.plane.labels.at(x, y) = kWallLabel;
      }
    }
  }
  EXPECT_EQ(count(unseen(views),
                  [](const Vec3d& p) {
                    return std::abs(p.z - 1.8) < 0.1 && std::abs(p.y - kFloor) > 0.1 &&
                           std::abs(p.y - kCeiling) > 0.1 && std::abs(std::abs(p.x) - kSide) > 0.1;
                  }),
            0u);
}

TEST(UnseenLayout, WithoutLabelsOrSurfacesThereIsNothing) {
  std::vector<LayoutView> views = photos();
  for (LayoutView& view : views) view.plane.labels = {};
  EXPECT_EQ(unseen(views).cloud.size(), 0u);
  views = photos();
  for (LayoutView& view : views) std::fill(view.plane.depth.data.begin(), view.plane.depth.data.end(), 0.0f);
  EXPECT_EQ(unseen(views).cloud.size(), 0u);
  EXPECT_EQ(unseen({}).cloud.size(), 0u);
}

TEST(UnseenLayout, DepthThatIsNoNumberIsNoSurface) {
  std::vector<LayoutView> views = photos(), without = photos();
  for (size_t i = 0; i < views[0].plane.depth.data.size(); i += 2) {
    views[0].plane.depth.data[i] = i % 4 == 0 ? NAN : INFINITY;
    without[0].plane.depth.data[i] = 0;
  }
  const UnseenLayout layout = unseen(views), wanted = unseen(without);
  ASSERT_GT(layout.cloud.size(), 300u);
  ASSERT_EQ(layout.cloud.size(), wanted.cloud.size());
  for (size_t i = 0; i < layout.cloud.size(); ++i) {
    EXPECT_EQ(layout.cloud.positions[i].x, wanted.cloud.positions[i].x);
    EXPECT_EQ(layout.cloud.positions[i].y, wanted.cloud.positions[i].y);
    EXPECT_EQ(layout.cloud.positions[i].z, wanted.cloud.positions[i].z);
  }
}

TEST(UnseenLayout, DoesNotDependOnThreads) {
  const UnseenLayout one = unseen(photos(), 1), three = unseen(photos(), 3);
  ASSERT_EQ(one.cloud.size(), three.cloud.size());
  for (size_t i = 0; i < one.cloud.size(); ++i) {
    EXPECT_EQ(one.cloud.positions[i].x, three.cloud.positions[i].x);
    EXPECT_EQ(one.cloud.colors[i].z, three.cloud.colors[i].z);
  }
}

TEST(UnseenLayout, AMapOfAnotherSizeThanItsCameraIsRefused) {
  std::vector<LayoutView> views = photos();
  views[1].color = ImageF(3, 3, 3);
  EXPECT_THROW(unseen(views), Error);
}

}  // namespace
}  // namespace aligngs
