#include "synth/room_truth.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "room/furniture.h"
#include "room/room_classes.h"

namespace aligngs {
namespace {

constexpr double kFlat = 0.12;  // metres from a wall that a picture on it ends

/// Vertices of each object in the room's own frame.
std::vector<std::vector<Vec3d>> points_of_objects(const RoomModel& room) {
  const Rigidd to_room = room.room_to_world.inverse();
  std::vector<std::vector<Vec3d>> out(room.objects.size());
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    for (const uint32_t v : room.triangles[t])
      out[room.triangle_object[t]].push_back(to_room * room.positions[v].cast<double>());
  }
  return out;
}

/// The rectangle of something flat on one of the walls; false where it is on none.
bool on_wall(const std::vector<MeasuredWall>& walls, const std::vector<Vec3d>& points, MeasuredOpening& out) {
  for (size_t w = 0; w < walls.size(); ++w) {
    const MeasuredWall& wall = walls[w];
    double farthest = 0;
    Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
    for (const Vec3d& p : points) {
      const double dx = p.x - wall.from.x, dy = p.y - wall.from.y;
      const double along = (dx * (wall.to.x - wall.from.x) + dy * (wall.to.y - wall.from.y)) / wall.length();
      farthest = std::max(farthest, std::abs(wall.normal.x * dx + wall.normal.y * dy));
      low = {std::min(low.x, along), std::min(low.y, p.z)};
      high = {std::max(high.x, along), std::max(high.y, p.z)};
    }
    if (farthest > kFlat) continue;
    out.wall = static_cast<int>(w);
    out.left = low.x;
    out.right = high.x;
    out.bottom = low.y;
    out.top = high.y;
    return true;
  }
  return false;
}

}  // namespace

MeasuredRoom room_truth(const RoomModel& model) {
  MeasuredRoom room;
  room.metric = true;
  room.scale_source = ScaleSource::kTruth;
  const Rigidd to_room = model.room_to_world.inverse();
  room.to_room = {1, to_room.rotation, to_room.translation};
  room.height = room.lowest = model.height;
  room.ceiling = {{{0, 0, -1}, model.height}};
  room.floor_seen = room.ceiling_seen = 1;
  const Vec2d corners[4] = {{0, 0}, {model.width, 0}, {model.width, model.depth}, {0, model.depth}};
  const Vec3d normals[4] = {{0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}};
  for (size_t w = 0; w < 4; ++w)
    room.walls.push_back({corners[w], corners[(w + 1) % 4], normals[w], model.height, 1, 1, false});
  for (const RoomOpening& o : model.openings) {
    room.openings.push_back({o.is_door ? OpeningKind::kDoor : OpeningKind::kWindow, o.is_door ? "door" : "windowpane",
                             o.wall, o.left, o.right, o.bottom, o.top, 1, 1});
  }

  const std::vector<RoomClass> classes = room_classes(ade20k_labels());
  const std::vector<std::vector<Vec3d>> points = points_of_objects(model);
  std::vector<ObjectPoints> furniture;
  std::map<std::string, int> numbers;
  for (size_t i = 0; i < model.objects.size(); ++i) {
    const RoomObject& object = model.objects[i];
    const RoomClass& c = classes[object.label];
    MeasuredOpening picture{OpeningKind::kPicture, object.class_name, 0, 0, 0, 0, 0, 1, 1};
    const bool hangs = c.opening == OpeningKind::kPicture || c.opening == OpeningKind::kMirror;
    if (hangs && on_wall(room.walls, points[i], picture)) {
      picture.kind = *c.opening;
      room.openings.push_back(picture);
    }
    if (c.furniture && !points[i].empty())
      furniture.push_back({object.class_name, ++numbers[object.class_name], points[i], 1});
  }
  FurnitureSettings exact;
  exact.tail = 0;
  exact.to_floor = 0.02;
  exact.least_points = 1;
  room.boxes = find_boxes(furniture, {room.walls, {}, room.height}, exact);
  for (MeasuredBox& box : room.boxes) box.seen = 1;
  return room;
}

}  // namespace aligngs
