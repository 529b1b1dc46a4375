#include "room/camera_tour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/angles.h"
#include "room/testing/sample_room.h"
#include "scene/look_at.h"

namespace aligngs {
namespace {

/// A photo in the frame of the sample room, taken to the world.
Camera photo(const MeasuredRoom& room, const Vec3d& eye, const Vec3d& target) {
  const Similarity back = room.to_room.inverse();
  Camera c;
  c.width = c.height = 100;
  c.fx = c.fy = 80;
  c.cx = c.cy = 50;
  c.world_to_camera = look_at(back * eye, back * target, normalized(back.rotation * Vec3d{0, 0, 1}));
  return c;
}

std::vector<Camera> photos(const MeasuredRoom& room) {
  return {photo(room, {0.5, 0.5, 1.4}, {2, 2, 1}), photo(room, {3.5, 0.5, 1.5}, {2, 2, 1}),
          photo(room, {3.4, 2.4, 1.6}, {1, 1, 1}), photo(room, {0.6, 2.5, 1.5}, {3, 1, 1}),
          photo(room, {2, 0.4, 1.5}, {2, 3, 1})};
}

/// The sample room with its corner beyond (2, 1.5) cut away.
MeasuredRoom angle_room() {
  MeasuredRoom room = sample_room::make();
  const Vec2d corners[6] = {{0, 0}, {4, 0}, {4, 1.5}, {2, 1.5}, {2, 3}, {0, 3}};
  room.walls.clear();
  for (size_t i = 0; i < 6; ++i)
    room.walls.push_back({corners[i], corners[(i + 1) % 6], {0, 0, 0}, 2.5, 0.9, 0.8, false});
  return room;
}

double least_clearance(const RoomInside& room, const CameraPath& path) {
  double least = 1e9;
  for (double t = 0; t <= path.duration(); t += path.duration() / 400) {
    const Vec3d p = room.to_room() * key_at(path, t).eye;
    least = std::min({least, room.clearance({p.x, p.y}), p.z, room.height() - p.z});
  }
  return least;
}

TEST(RoomInside, ClearanceIsNegativeOutside) {
  const RoomInside room = RoomInside::of_room(angle_room());
  EXPECT_NEAR(room.clearance({1, 0.5}), 0.5, 1e-12);
  EXPECT_NEAR(room.clearance({3, 2.5}), -1, 1e-12);
  EXPECT_NEAR(room.diagonal(), 5, 1e-12);
}

TEST(RoomInside, InsideKeepsTheMargin) {
  const RoomInside room = RoomInside::of_room(angle_room());
  for (double x = -1; x <= 5; x += 0.25) {
    for (double y = -1; y <= 4; y += 0.25)
      EXPECT_GE(room.clearance(room.inside({x, y})), 0.5 * room.margin()) << x << " " << y;
  }
  const Vec2d kept = room.inside({1, 1});
  EXPECT_EQ(kept.x, 1);
  EXPECT_EQ(kept.y, 1);
}

TEST(RoomInside, BoxOfPointsIsUprightAndTight) {
  std::vector<Vec3d> points;
  const double a = 0.4;
  for (double x = 0; x <= 4; x += 0.1) {
    for (double y = 0; y <= 3; y += 0.1) {
      for (const double z : {0.0, 2.5})
        points.push_back({x * std::cos(a) - y * std::sin(a), x * std::sin(a) + y * std::cos(a), z + 7});
    }
  }
  const RoomInside room = RoomInside::of_points(points, {0, 0, 1});
  EXPECT_NEAR(room.height(), 2.5, 1e-9);
  EXPECT_NEAR(room.diagonal(), 5, 0.4);
  const Vec3d middle =
      room.to_room() * Vec3d{2 * std::cos(a) - 1.5 * std::sin(a), 2 * std::sin(a) + 1.5 * std::cos(a), 8};
  EXPECT_GT(room.clearance({middle.x, middle.y}), 1.2);
  EXPECT_NEAR(middle.z, 1, 1e-9);
}

TEST(RoomInside, ObstaclesAtTheHeightOfTheCameraEndARay) {
  RoomInside room = RoomInside::of_room(sample_room::make());
  const Similarity back = room.to_room().inverse();
  std::vector<Vec3d> wardrobe, table;
  for (double y = 1; y < 2; y += 0.01)
    wardrobe.push_back(back * Vec3d{3, y, 1.5}), table.push_back(back * Vec3d{1, y, 0.7});
  room.add_obstacles(wardrobe, 1.5);
  room.add_obstacles(table, 1.5);
  EXPECT_NEAR(room.free_distance({2, 1.5}, {1, 0}), 1, 0.1);
  EXPECT_NEAR(room.free_distance({2, 1.5}, {-1, 0}), 2, 1e-9);
}

TEST(CameraTour, OrbitStaysInsideAndCloses) {
  for (const MeasuredRoom& measured : {sample_room::make(), angle_room()}) {
    const RoomInside room = RoomInside::of_room(measured);
    const CameraPath path = orbit_path(room, photos(measured), 16);
    EXPECT_DOUBLE_EQ(path.duration(), 16);
    EXPECT_GT(least_clearance(room, path), 0.05);
    EXPECT_NEAR(norm(path.keys.front().eye - path.keys.back().eye), 0, 1e-12);
  }
}

TEST(CameraTour, OrbitGivesWayToAnObstacle) {
  const MeasuredRoom measured = sample_room::make();
  RoomInside room = RoomInside::of_room(measured);
  const auto farthest = [&](const RoomInside& r) {
    double most = 0;
    for (const CameraKey& k : orbit_path(r, photos(measured), 16).keys) most = std::max(most, (r.to_room() * k.eye).x);
    return most;
  };
  const double free = farthest(room);
  std::vector<Vec3d> wardrobe;
  for (double y = 0; y < 3; y += 0.005)
    wardrobe.push_back(room.to_room().inverse() * Vec3d{3, y, tour_height(room, photos(measured))});
  room.add_obstacles(wardrobe, tour_height(room, photos(measured)));
  EXPECT_GT(free, 3);
  EXPECT_LT(farthest(room), 2.9);
}

TEST(CameraTour, WalkStaysInsideAndPassesThePhotos) {
  const MeasuredRoom plain = sample_room::make();
  const RoomInside room = RoomInside::of_room(plain);
  const CameraPath path = walk_path(room, photos(plain), 10);
  EXPECT_NEAR(path.duration(), 10, 1e-9);
  EXPECT_GT(least_clearance(room, path), 0.1);
  for (const Camera& c : photos(plain)) {
    double nearest = 1e9;
    for (const CameraKey& k : path.keys) {
      const Vec3d a = room.to_room() * k.eye, b = room.to_room() * c.centre();
      nearest = std::min(nearest, std::hypot(a.x - b.x, a.y - b.y));
    }
    EXPECT_LT(nearest, 0.35);
  }
}

TEST(CameraTour, WalkDoesNotCutTheCornerOfAnAngledRoom) {
  const MeasuredRoom measured = angle_room();
  const RoomInside room = RoomInside::of_room(measured);
  const std::vector<Camera> ends = {photo(measured, {3.6, 0.8, 1.5}, {1, 0.5, 1}),
                                    photo(measured, {1, 2.6, 1.5}, {1, 0.5, 1})};
  EXPECT_GT(least_clearance(room, walk_path(room, ends, 10)), 0.05);
}

TEST(CameraTour, WalkOfOnePhotoIsOnePlace) {
  const MeasuredRoom measured = sample_room::make();
  const CameraPath path = walk_path(RoomInside::of_room(measured), {photos(measured)[0]}, 10);
  EXPECT_EQ(path.keys.size(), 1u);
}

}  // namespace
}  // namespace aligngs
