#include "room/room_inside.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angles.h"
#include "core/error.h"

namespace aligngs {
namespace {

constexpr size_t kFewestPoints = 16;
constexpr double kTail = 0.02;    // share of the points at either end that are haze behind the walls
constexpr int kDirections = 30;   // of walls that are tried, over a right angle
constexpr double kMargin = 0.05;  // of the diagonal: 0.3 m in a room of 4 m by 5 m
constexpr int kCells = 64;        // along the diagonal: 0.1 m in such a room
constexpr int kBlocking = 4;      // points in a cell that block it: fewer are haze
constexpr double kBand = 0.06;    // of the room's height above and below the camera: 0.15 m
constexpr int kSteps = 12;        // of moving away from walls, one or two of them in a corner

Vec2d along(const Vec2d& p, const Vec2d& d, double t) { return {p.x + d.x * t, p.y + d.y * t}; }

/// The part of sorted-to-be values between the two tails.
std::pair<double, double> range_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  return {values[static_cast<size_t>(kTail * n)], values[static_cast<size_t>((1 - kTail) * n)]};
}

/// The nearest place of a side to p.
Vec2d nearest_on(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
  const double dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0;
  return {a.x + t * dx, a.y + t * dy};
}

/// Turns the world so that `up` is z and the level axis `x` is x.
Mat3d upright(const Vec3d& x, const Vec3d& up) {
  const Vec3d y = cross(up, x);
  return {{x.x, x.y, x.z, y.x, y.y, y.z, up.x, up.y, up.z}};
}

}  // namespace

RoomInside::RoomInside(Similarity to_room, std::vector<Vec2d> outline, double height)
    : to_room_(to_room),
      outline_(std::move(outline)),
      height_(height),
      low_(outline_.front()),
      high_(outline_.front()) {
  for (const Vec2d& p : outline_) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
  }
  diagonal_ = std::max(1e-9, std::hypot(high_.x - low_.x, high_.y - low_.y));
  cell_ = diagonal_ / kCells;
  columns_ = static_cast<int>((high_.x - low_.x) / cell_) + 1;
  rows_ = static_cast<int>((high_.y - low_.y) / cell_) + 1;
  double most = -std::numeric_limits<double>::infinity();
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) {
      const Vec2d p{low_.x + (c + 0.5) * cell_, low_.y + (r + 0.5) * cell_};
      if (const double d = clearance(p); d > most) most = d, anchor_ = p;
    }
  }
}

RoomInside RoomInside::of_room(const MeasuredRoom& room) {
  std::vector<Vec2d> outline;
  for (const MeasuredWall& wall : room.walls) outline.push_back(wall.from);
  return {room.to_room, outline, room.lowest};
}

RoomInside RoomInside::of_points(const std::vector<Vec3d>& points, const Vec3d& up) {
  if (points.size() < kFewestPoints)
    throw_bad_input({}, {}, "the scene has too few Gaussians for a room", "train it for longer");
  const Vec3d level = normalized(cross(up, std::fabs(up.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})),
              side = cross(up, level);
  Mat3d best;
  double least = std::numeric_limits<double>::infinity();
  std::pair<double, double> ranges[3];
  const auto range = [&](const Vec3d& axis) {
    std::vector<double> values;
    for (const Vec3d& p : points) values.push_back(dot(p, axis));
    return range_of(std::move(values));
  };
  for (int k = 0; k < kDirections; ++k) {
    const double a = k * (kPi / 2) / kDirections;
    const Mat3d turned = upright(level * std::cos(a) + side * std::sin(a), up);
    const auto x = range(turned.row(0)), y = range(turned.row(1));
    const double area = (x.second - x.first) * (y.second - y.first);
    if (area < least) least = area, best = turned, ranges[0] = x, ranges[1] = y;
  }
  ranges[2] = range(up);
  Similarity to_room;
  to_room.rotation = best;
  to_room.translation = {-ranges[0].first, -ranges[1].first, -ranges[2].first};
  const double w = ranges[0].second - ranges[0].first, d = ranges[1].second - ranges[1].first;
  return {to_room, {{0, 0}, {w, 0}, {w, d}, {0, d}}, ranges[2].second - ranges[2].first};
}

void RoomInside::add_obstacles(const std::vector<Vec3d>& points, double height) {
  counts_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0);
  for (const Vec3d& world : points) {
    const Vec3d p = to_room_ * world;
    if (!(std::fabs(p.z - height) <= kBand * height_) ||
        !(p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y))
      continue;
    const int c = static_cast<int>((p.x - low_.x) / cell_), r = static_cast<int>((p.y - low_.y) / cell_);
    ++counts_[static_cast<size_t>(r) * static_cast<size_t>(columns_) + static_cast<size_t>(c)];
  }
}

double RoomInside::margin() const { return kMargin * diagonal_; }

double RoomInside::clearance(const Vec2d& p) const {
  double least = std::numeric_limits<double>::infinity();
  bool within = false;
  for (size_t i = 0; i < outline_.size(); ++i) {
    const Vec2d &a = outline_[i], &b = outline_[(i + 1) % outline_.size()], q = nearest_on(a, b, p);
    least = std::min(least, std::hypot(p.x - q.x, p.y - q.y));
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) within = !within;
  }
  return within ? least : -least;
}

Vec2d RoomInside::inside(const Vec2d& p) const {
  const double kept = std::min(margin(), 0.8 * clearance(anchor_));
  Vec2d at = p;
  for (int step = 0; step < kSteps && clearance(at) < kept; ++step) {
    double least = std::numeric_limits<double>::infinity();
    Vec2d moved = at;
    for (size_t i = 0; i < outline_.size(); ++i) {
      const Vec2d &a = outline_[i], &b = outline_[(i + 1) % outline_.size()], q = nearest_on(a, b, at);
      if (const double d = std::hypot(at.x - q.x, at.y - q.y); d < least) {
        least = d;
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        // the room is on the left of its sides
        moved = along(q, {-(b.y - a.y) / length, (b.x - a.x) / length}, kept * 1.001);
      }
    }
    at = moved;
  }
  for (double t = 0; t <= 1 && clearance(at) < 0.5 * kept; t += 0.02)
    at = {p.x + t * (anchor_.x - p.x), p.y + t * (anchor_.y - p.y)};
  return at;
}

double RoomInside::wall_distance(const Vec2d& from, const Vec2d& d) const {
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < outline_.size(); ++i) {
    const Vec2d &a = outline_[i], &b = outline_[(i + 1) % outline_.size()], s{b.x - a.x, b.y - a.y};
    const double cross = d.x * s.y - d.y * s.x;
    if (cross == 0) continue;
    const double t = ((a.x - from.x) * s.y - (a.y - from.y) * s.x) / cross,
                 u = ((a.x - from.x) * d.y - (a.y - from.y) * d.x) / cross;
    if (t >= 0 && u >= 0 && u <= 1) least = std::min(least, t);
  }
  return std::isfinite(least) ? least : 0;
}

double RoomInside::free_distance(const Vec2d& from, const Vec2d& direction) const {
  const double wall = wall_distance(from, direction);
  for (double t = cell_; t < wall; t += 0.5 * cell_) {
    if (blocked(along(from, direction, t))) return t;
  }
  return wall;
}

bool RoomInside::blocked(const Vec2d& p) const {
  if (counts_.empty()) return false;
  const int c = static_cast<int>(std::floor((p.x - low_.x) / cell_)),
            r = static_cast<int>(std::floor((p.y - low_.y) / cell_));
  if (c < 0 || r < 0 || c >= columns_ || r >= rows_) return false;
  return counts_[static_cast<size_t>(r) * static_cast<size_t>(columns_) + static_cast<size_t>(c)] >= kBlocking;
}

}  // namespace aligngs
