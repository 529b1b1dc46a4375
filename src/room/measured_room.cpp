#include "room/measured_room.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/is_depth.h"

namespace aligngs {

double MeasuredWall::length() const { return std::hypot(to.x - from.x, to.y - from.y); }

double MeasuredWall::along(const Vec2d& p) const {
  return ((p.x - from.x) * (to.x - from.x) + (p.y - from.y) * (to.y - from.y)) / length();
}

double MeasuredWall::before(const Vec2d& p) const { return normal.x * (p.x - from.x) + normal.y * (p.y - from.y); }

Vec3d MeasuredWall::at(double along, double z) const {
  const double whole = length(), t = whole > 0 ? along / whole : 0;
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), z};
}

double CeilingPlane::height_at(const Vec2d& p) const { return -(normal.x * p.x + normal.y * p.y + offset) / normal.z; }

double signed_area(const std::vector<Vec2d>& polygon) {
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

double MeasuredRoom::area() const {
  std::vector<Vec2d> outline;
  for (const MeasuredWall& wall : walls) outline.push_back(wall.from);
  return signed_area(outline);
}

double MeasuredRoom::perimeter() const {
  double sum = 0;
  for (const MeasuredWall& wall : walls) sum += wall.length();
  return sum;
}

double MeasuredRoom::height_at(const Vec2d& p) const {
  // A ceiling of several planes is the lowest of them at each place: roofs are hollow towards the room.
  double least = height;
  for (const CeilingPlane& plane : ceiling) {
    const double z = plane.height_at(p);
    if (is_depth(z)) least = std::min(least, z);
  }
  return least;
}

std::string wall_name(size_t index) { return "wall." + std::to_string(index + 1); }

std::string opening_name(const MeasuredRoom& room, size_t index) {
  const OpeningKind kind = room.openings[index].kind;
  size_t number = 0;
  for (size_t i = 0; i <= index; ++i) number += room.openings[i].kind == kind;
  return std::string(name_of(kind)) + "." + std::to_string(number);
}

std::string box_name(const MeasuredBox& box) { return box.class_name + "." + std::to_string(box.instance); }

bool is_within(const MeasuredBox& box, const Vec2d& p) {
  const double c = std::cos(box.turn * kRadiansPerDegree), s = std::sin(box.turn * kRadiansPerDegree),
               x = p.x - box.centre.x, y = p.y - box.centre.y;
  return std::abs(c * x + s * y) <= box.width / 2 && std::abs(-s * x + c * y) <= box.depth / 2;
}

std::vector<Vec2d> footprint(const MeasuredBox& box) {
  const double c = std::cos(box.turn * kRadiansPerDegree), s = std::sin(box.turn * kRadiansPerDegree);
  std::vector<Vec2d> out;
  for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double x = u * box.width / 2, y = v * box.depth / 2;
    out.push_back({box.centre.x + c * x - s * y, box.centre.y + s * x + c * y});
  }
  return out;
}

bool is_inside(const std::vector<MeasuredWall>& walls, const Vec2d& p) {
  bool in = false;
  for (const MeasuredWall& w : walls) {
    if ((w.from.y > p.y) != (w.to.y > p.y) &&
        p.x < w.from.x + (p.y - w.from.y) / (w.to.y - w.from.y) * (w.to.x - w.from.x))
      in = !in;
  }
  return in;
}

MeasuredRoom rescaled(MeasuredRoom room, double factor) {
  const auto scale = [factor](Vec2d& p) { p = {p.x * factor, p.y * factor}; };
  for (MeasuredWall& w : room.walls) {
    scale(w.from);
    scale(w.to);
    w.height *= factor;
  }
  for (MeasuredOpening& o : room.openings) {
    for (double* length : {&o.left, &o.right, &o.bottom, &o.top}) *length *= factor;
  }
  for (MeasuredBox& b : room.boxes) {
    scale(b.centre);
    for (double* length : {&b.width, &b.depth, &b.bottom, &b.top}) *length *= factor;
    if (!b.shown) continue;
    scale(b.shown->centre);
    for (double* length : {&b.shown->width, &b.shown->depth, &b.shown->bottom, &b.shown->top}) *length *= factor;
  }
  for (CeilingPlane& p : room.ceiling) p.offset *= factor;
  room.height *= factor;
  room.lowest *= factor;
  room.to_room.scale *= factor;
  room.to_room.translation *= factor;
  return room;
}

const char* name_of(OpeningKind kind) {
  switch (kind) {
    case OpeningKind::kDoor:
      return "door";
    case OpeningKind::kWindow:
      return "window";
    case OpeningKind::kPicture:
      return "picture";
    case OpeningKind::kMirror:
      return "mirror";
  }
  return "";
}

const char* name_of(RoomEvidence found_by) { return found_by == RoomEvidence::kLabels ? "labels" : "geometry"; }

const char* name_of(ScaleSource source) {
  switch (source) {
    case ScaleSource::kUnknown:
      return "unknown";
    case ScaleSource::kNetwork:
      return "network estimate";
    case ScaleSource::kSensor:
      return "sensor";
    case ScaleSource::kGiven:
      return "given";
    case ScaleSource::kTruth:
      return "truth";
  }
  return "";
}

}  // namespace aligngs
