#include "room/furniture.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/quantile.h"
#include "room/largest_cluster.h"

namespace aligngs {
namespace {

/// Metres that the longest side of a whole thing has at least. Shorter ones are cushions and drawers that a teacher
/// takes for it.
double least_size_of(const std::string& class_name, double least) {
  constexpr std::pair<const char*, double> kLeast[] = {{"bed", 1.0},         {"sofa", 1.0},     {"wardrobe", 1.0},
                                                       {"bathtub", 1.0},     {"bookcase", 0.5}, {"desk", 0.5},
                                                       {"refrigerator", 0.5}};
  for (const auto& [name, size] : kLeast) {
    if (class_name == name) return std::max(size, least);
  }
  return least;
}

constexpr size_t kMostTurned = 4000;  // points that turns are compared on

struct Range {
  double low = 0, high = 0;
  double length() const { return high - low; }
};

/// Without the tail on each side.
Range range_of(const std::vector<double>& values, double tail) {
  return {quantile_of(values, tail), quantile_of(values, 1 - tail)};
}

struct Turned {
  Range u, v;
  double closeness = 0;  // mean over points of near / distance to the nearest side
};

Turned turned_box(const std::vector<Vec3d>& points, double degrees, double tail, double near) {
  const double c = std::cos(degrees * kRadiansPerDegree), s = std::sin(degrees * kRadiansPerDegree);
  std::vector<double> u, v;
  for (const Vec3d& p : points) {
    u.push_back(c * p.x + s * p.y);
    v.push_back(-s * p.x + c * p.y);
  }
  Turned out{range_of(u, tail), range_of(v, tail), 0};
  for (size_t i = 0; i < u.size(); ++i) {
    const double to_side = std::min(std::min(std::abs(u[i] - out.u.low), std::abs(u[i] - out.u.high)),
                                    std::min(std::abs(v[i] - out.v.low), std::abs(v[i] - out.v.high)));
    out.closeness += near / std::max(near, to_side) / static_cast<double>(u.size());
  }
  return out;
}

/// Share of the squares of the top and the four sides that have a point near them.
double seen_share(const MeasuredBox& box, const std::vector<Vec3d>& points, double cell) {
  const double size[3] = {box.width, box.depth, box.top - box.bottom};
  int count[3];
  for (int k = 0; k < 3; ++k) count[k] = std::clamp(static_cast<int>(std::ceil(size[k] / cell)), 1, 200);
  // Faces: top, -u, +u, -v, +v.
  std::vector<uint8_t> faces[5];
  const int wide[5] = {count[0], count[1], count[1], count[0], count[0]},
            high[5] = {count[1], count[2], count[2], count[2], count[2]};
  for (int f = 0; f < 5; ++f) faces[f].assign(static_cast<size_t>(wide[f]) * static_cast<size_t>(high[f]), 0);
  const double c = std::cos(box.turn * kRadiansPerDegree), s = std::sin(box.turn * kRadiansPerDegree);
  const auto square = [](double at, double whole, int n) {
    return std::clamp(static_cast<int>(at / whole * n), 0, n - 1);
  };
  for (const Vec3d& p : points) {
    if (!std::isfinite(dot(p, p))) continue;
    const double x = p.x - box.centre.x, y = p.y - box.centre.y;
    const double u = c * x + s * y + box.width / 2, v = -s * x + c * y + box.depth / 2, z = p.z - box.bottom;
    const int i = square(u, size[0], count[0]), j = square(v, size[1], count[1]), k = square(z, size[2], count[2]);
    const auto mark = [&](int f, int a, int b) {
      faces[f][static_cast<size_t>(b) * static_cast<size_t>(wide[f]) + static_cast<size_t>(a)] = 1;
    };
    if (size[2] - z < cell) mark(0, i, j);
    if (u < cell) mark(1, j, k);
    if (size[0] - u < cell) mark(2, j, k);
    if (v < cell) mark(3, i, k);
    if (size[1] - v < cell) mark(4, i, k);
  }
  size_t seen = 0, all = 0;
  for (const auto& face : faces) {
    all += face.size();
    for (const uint8_t f : face) seen += f;
  }
  return static_cast<double>(seen) / static_cast<double>(all);
}

double to_wall(const MeasuredBox& box, const MeasuredWall& wall) {
  double nearest = 1e300;
  for (const Vec2d& p : footprint(box)) {
    const double along = wall.along(p);
    if (along < -0.1 || along > wall.length() + 0.1) continue;
    nearest = std::min(nearest, std::abs(wall.before(p)));
  }
  return nearest;
}

/// How far the farthest corner of a box is behind a wall; 0 for corners before it or beyond its ends.
double behind(const MeasuredBox& box, const MeasuredWall& wall) {
  double farthest = 0;
  for (const Vec2d& p : footprint(box)) {
    const double along = wall.along(p);
    if (along < 0 || along > wall.length()) continue;
    farthest = std::max(farthest, -wall.before(p));
  }
  return farthest;
}

/// The part of a box before a wall that runs along one of its sides, if only a little of it is behind.
void cut_back(MeasuredBox& box, const MeasuredWall& wall, double most) {
  const double c = std::cos(box.turn * kRadiansPerDegree), s = std::sin(box.turn * kRadiansPerDegree);
  const double along = wall.along(box.centre);
  if (along < 0 || along > wall.length()) return;
  constexpr double kParallel = 0.999;  // cosine: 2.5 degrees
  for (double* side : {&box.width, &box.depth}) {
    const Vec2d axis = side == &box.width ? Vec2d{c, s} : Vec2d{-s, c};
    if (std::abs(wall.normal.x * axis.x + wall.normal.y * axis.y) < kParallel) continue;
    const double centre = wall.before(box.centre);
    const double behind = *side / 2 - centre;
    if (behind <= 0 || behind > most || behind >= *side) continue;
    *side -= behind;
    box.centre = {box.centre.x + wall.normal.x * behind / 2, box.centre.y + wall.normal.y * behind / 2};
  }
}

std::string support_of(const MeasuredBox& box, const std::vector<MeasuredBox>& boxes,
                       const std::vector<MeasuredWall>& walls, double height, const FurnitureSettings& s) {
  if (box.bottom < s.to_floor) return "floor";
  for (const MeasuredBox& other : boxes) {
    // A thing may be on a shelf inside its case's box: only the top is known.
    if (&other != &box && is_within(other, box.centre) && std::abs(box.bottom - other.top) < s.to_support)
      return box_name(other);
  }
  for (const MeasuredWall& wall : walls) {
    if (can_hang_on_wall(box.class_name) && wall.length() > 0 && to_wall(box, wall) < s.to_support) return "wall";
  }
  return height - box.top < s.to_support ? "ceiling" : "unknown";
}

}  // namespace

std::vector<ObjectPoints> join_pieces(std::vector<ObjectPoints> objects, double link, double gap) {
  for (ObjectPoints& object : objects) object.points = largest_cluster(object.points, link);
  constexpr double kRow = 0.7;  // of the shorter piece's width that lies beside the other
  const auto box_of = [](const ObjectPoints& object) {
    std::vector<double> x, y;
    for (const Vec3d& p : object.points) {
      if (!std::isfinite(dot(p, p))) continue;
      x.push_back(p.x);
      y.push_back(p.y);
    }
    constexpr double kTail = 0.01;
    return x.empty() ? std::pair<Range, Range>{}
                     : std::pair{range_of(std::move(x), kTail), range_of(std::move(y), kTail)};
  };
  const auto overlap = [](const Range& a, const Range& b) { return std::min(a.high, b.high) - std::max(a.low, b.low); };
  for (bool joined = true; joined;) {
    joined = false;
    for (size_t i = 0; i < objects.size() && !joined; ++i) {
      if (objects[i].class_name != "bed" && objects[i].class_name != "sofa") continue;
      for (size_t j = i + 1; j < objects.size() && !joined; ++j) {
        if (objects[j].class_name != objects[i].class_name || objects[i].points.empty() || objects[j].points.empty())
          continue;
        const auto [ax, ay] = box_of(objects[i]);
        const auto [bx, by] = box_of(objects[j]);
        const auto in_row = [&](const Range& a, const Range& b, const Range& c, const Range& d) {
          return overlap(a, b) > -gap && overlap(c, d) > kRow * std::min(c.length(), d.length());
        };
        if (!in_row(ax, bx, ay, by) && !in_row(ay, by, ax, bx)) continue;
        const double m = static_cast<double>(objects[i].points.size()),
                     n = static_cast<double>(objects[j].points.size());
        objects[i].confidence = (m * objects[i].confidence + n * objects[j].confidence) / (m + n);
        objects[i].points.insert(objects[i].points.end(), objects[j].points.begin(), objects[j].points.end());
        objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(j));
        joined = true;
      }
    }
  }
  std::erase_if(objects, [](const ObjectPoints& object) { return object.points.empty(); });
  return objects;
}

bool fit_box(const ObjectPoints& object, const FurnitureSettings& s, MeasuredBox& box) {
  std::vector<Vec3d> points;
  for (const Vec3d& p : object.points) {
    if (std::isfinite(dot(p, p))) points.push_back(p);
  }
  if (points.size() < std::max<size_t>(1, s.least_points)) return false;
  std::vector<double> heights;
  for (const Vec3d& p : points) heights.push_back(p.z);
  const Range z = range_of(std::move(heights), s.tail);
  // Thousands of points give the same turn as all of them.
  std::vector<Vec3d> some;
  for (size_t i = 0; i < points.size(); i += 1 + points.size() / kMostTurned) some.push_back(points[i]);
  double turn = 0, most = turned_box(some, 0, s.tail, s.near_side).closeness * (1 + s.square_gain);
  for (int degrees = 2; degrees < 90; degrees += 2) {
    const double closeness = turned_box(some, degrees, s.tail, s.near_side).closeness;
    if (closeness > most) most = closeness, turn = degrees;
  }
  const Turned best = turned_box(points, turn, s.tail, s.near_side);
  box.class_name = object.class_name;
  box.instance = object.instance;
  box.confidence = object.confidence;
  box.width = best.u.length();
  box.depth = best.v.length();
  box.bottom = z.low < s.to_floor ? 0 : z.low;
  box.top = z.high;
  box.turn = turn;
  if (std::max({box.width, box.depth, box.top - box.bottom}) < least_size_of(box.class_name, s.least_size) ||
      box.top <= box.bottom || box.width <= 0 || box.depth <= 0)
    return false;
  const double u = (best.u.low + best.u.high) / 2, v = (best.v.low + best.v.high) / 2;
  const double c = std::cos(turn * kRadiansPerDegree), sine = std::sin(turn * kRadiansPerDegree);
  box.centre = {c * u - sine * v, sine * u + c * v};
  box.seen = seen_share(box, points, s.cell);
  return true;
}

std::vector<MeasuredBox> find_boxes(const std::vector<ObjectPoints>& objects, const FurnitureSurroundings& around,
                                    const FurnitureSettings& settings) {
  std::vector<MeasuredBox> out;
  std::vector<const ObjectPoints*> sources;
  for (const ObjectPoints& object : objects) {
    MeasuredBox box;
    if (!fit_box(object, settings, box)) continue;
    // Few points tell a wrong turn. One that pushes a corner through a wall is wrong.
    const bool through = std::any_of(around.walls.begin(), around.walls.end(), [&](const MeasuredWall& wall) {
      return behind(box, wall) > settings.through_wall;
    });
    if (through && box.turn != 0) {
      FurnitureSettings square = settings;
      square.square_gain = 1e9;  // no turn is so much better
      if (!fit_box(object, square, box)) continue;
    }
    for (const MeasuredWall& wall : around.walls) cut_back(box, wall, settings.in_wall);
    box.shown = ShownBox{box.centre, box.width, box.depth, box.bottom, box.top, box.turn};
    out.push_back(std::move(box));
    sources.push_back(&object);
  }
  const auto set_supports = [&] {
    for (MeasuredBox& box : out) box.support = support_of(box, out, around.walls, around.height, settings);
  };
  reach_walls(out, around.walls, around.rays, settings.unseen);
  set_supports();
  reach_down(out, around.rays, settings.unseen);
  set_supports();
  for (size_t i = 0; i < out.size(); ++i) out[i].seen = seen_share(out[i], sources[i]->points, settings.cell);
  return out;
}

}  // namespace aligngs
