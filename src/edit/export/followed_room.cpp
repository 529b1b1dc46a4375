#include "edit/export/followed_room.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "edit/export/furniture_points.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"
#include "room/find_room.h"
#include "room/followed_boxes.h"

namespace aligngs {
namespace {

constexpr double kBesideWall = 0.3;      // metres from a wall within which Gaussians may be of its openings
constexpr size_t kFewestOfOpening = 10;  // Gaussians; of fewer nothing follows
constexpr double kMostGone = 0.5;        // share of its Gaussians

/// Metres, by which settings of furniture are measured, per unit of the room.
double metres_of(const MeasuredRoom& room, const EditableRoom& trained) {
  if (trained.metric) return 1 / room.to_room.scale;
  return RoomSettings().usual_height / room.height;  // as find_room() takes it
}

/// Gaussians of the class of an opening that lie in its rectangle.
size_t gaussians_in(const EditableRoom& room, const MeasuredRoom& measured, const MeasuredOpening& opening) {
  const int label = room.labels.find(opening.class_name);
  const MeasuredWall& wall = measured.walls[static_cast<size_t>(opening.wall)];
  const GaussianModel& model = room.gaussians.model;
  size_t count = 0;
  for (size_t i = 0; i < room.gaussians.labels.label.size(); ++i) {
    if (room.gaussians.labels.label[i] != label || opacity_of(model, i) < kSolidOpacity) continue;
    const Vec3d p = measured.to_room * position_of(model, i);
    const double along = wall.along({p.x, p.y});
    count += along >= opening.left && along <= opening.right && p.z >= opening.bottom && p.z <= opening.top &&
             std::fabs(wall.before({p.x, p.y})) <= kBesideWall;
  }
  return count;
}

}  // namespace

std::optional<MeasuredRoom> followed_room(const MeasuredRoom& measured, const EditableRoom& trained,
                                          const EditableRoom& edited, ThreadPool& pool) {
  if (!can_follow(measured.boxes)) return std::nullopt;
  const double metres = metres_of(measured, trained);
  MeasuredRoom room = rescaled(measured, metres);
  std::vector<ObjectPoints> objects = furniture_points(edited, pool);
  for (ObjectPoints& object : objects) {
    for (Vec3d& p : object.points) p = room.to_room * p;
  }
  room.boxes = followed_boxes(room, std::move(objects));
  std::erase_if(room.openings, [&](const MeasuredOpening& opening) {
    const size_t before = gaussians_in(trained, room, opening);
    return before >= kFewestOfOpening &&
           static_cast<double>(gaussians_in(edited, room, opening)) < (1 - kMostGone) * static_cast<double>(before);
  });
  return rescaled(std::move(room), 1 / metres);
}

}  // namespace aligngs
