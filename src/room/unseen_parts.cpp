#include "room/unseen_parts.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/angles.h"
#include "core/quantile.h"

namespace aligngs {
namespace {

// Things with straight fronts whose back is mostly at a wall.
constexpr std::string_view kCases[] = {
    "cabinet", "wardrobe", "chest of drawers", "bookcase", "case", "buffet", "refrigerator",
    "stove",   "oven",     "dishwasher",       "washer"};
// Furniture with feet on the floor, unless something else is below it.
constexpr std::string_view kOnFloor[] = {
    "bed",     "cradle",       "sofa",   "chair",      "armchair", "swivel chair",     "stool",
    "ottoman", "bench",        "table",  "desk",       "wardrobe", "chest of drawers", "refrigerator",
    "stove",   "coffee table", "washer", "dishwasher", "bathtub",  "kitchen island",   "pool table"};

template <size_t N>
bool is_one_of(const std::string_view (&names)[N], std::string_view name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

/// Space between a front and its wall: `along` the wall from its first corner, `away` from it, and heights.
struct Gap {
  const MeasuredWall* wall = nullptr;
  double low_along = 0, high_along = 0, depth = 0, bottom = 0, top = 0;

  Vec3d of(const Vec3d& p) const { return {wall->along({p.x, p.y}), wall->before({p.x, p.y}), p.z}; }
};

/// Share of the gap's cubes that the way to a seen surface crosses. The surface itself, and all behind it, is not free.
double free_share(const Gap& gap, const std::vector<SeenRay>& rays, double cell) {
  const Vec3d low{gap.low_along, 0, gap.bottom}, high{gap.high_along, gap.depth, gap.top};
  int count[3];
  for (int k = 0; k < 3; ++k) count[k] = std::max(1, static_cast<int>(std::ceil((high[k] - low[k]) / cell)));
  std::vector<uint8_t> free(static_cast<size_t>(count[0]) * static_cast<size_t>(count[1]) *
                            static_cast<size_t>(count[2]));
  for (const SeenRay& ray : rays) {
    const Vec3d from = gap.of(ray.from), to = gap.of(ray.to), way = to - from;
    double enter = 0, leave = 1;
    for (int k = 0; k < 3; ++k) {
      if (std::abs(way[k]) < 1e-12) {
        if (from[k] < low[k] || from[k] > high[k]) leave = -1;
        continue;
      }
      const double a = (low[k] - from[k]) / way[k], b = (high[k] - from[k]) / way[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    const double length = norm(way);
    for (double at = enter; at < leave; at += cell / 2 / length) {
      size_t index = 0;
      for (int k = 0; k < 3; ++k) {
        const int i = static_cast<int>((from[k] + at * way[k] - low[k]) / (high[k] - low[k]) * count[k]);
        index = index * static_cast<size_t>(count[k]) + static_cast<size_t>(std::clamp(i, 0, count[k] - 1));
      }
      free[index] = 1;
    }
  }
  return static_cast<double>(std::count(free.begin(), free.end(), 1)) / static_cast<double>(free.size());
}

/// The middle of another thing lies in the gap.
bool occupied(const Gap& gap, const std::vector<MeasuredBox>& boxes, const MeasuredBox& own) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const MeasuredBox& other) {
    const Vec3d p = gap.of({other.centre.x, other.centre.y, (other.bottom + other.top) / 2});
    return &other != &own && p.x > gap.low_along && p.x < gap.high_along && p.y > 0 && p.y < gap.depth &&
           p.z > gap.bottom && p.z < gap.top;
  });
}

void reach_wall(MeasuredBox& box, const MeasuredWall& wall, const std::vector<MeasuredBox>& boxes,
                const std::vector<SeenRay>& rays, const UnseenPartsSettings& s) {
  if (!(wall.length() > 0)) return;
  const double c = std::cos(box.turn * kRadiansPerDegree), sine = std::sin(box.turn * kRadiansPerDegree);
  constexpr double kParallel = 0.999;  // cosine: 2.5 degrees
  const double facing = std::abs(wall.normal.x * c + wall.normal.y * sine);
  if (facing < kParallel && facing > std::sqrt(1 - kParallel * kParallel)) return;
  double& thickness = facing > 0.5 ? box.width : box.depth;
  const double length = facing > 0.5 ? box.depth : box.width;
  Gap gap{&wall, 0, 0, 0, box.bottom, box.top};
  const Vec3d centre = gap.of({box.centre.x, box.centre.y, 0});
  gap.depth = centre.y - thickness / 2;
  gap.low_along = std::max(0.0, centre.x - length / 2);
  gap.high_along = std::min(wall.length(), centre.x + length / 2);
  if (gap.depth < s.least_gap || gap.depth + thickness > s.most_depth ||
      gap.high_along - gap.low_along < s.beside * length || thickness > length || occupied(gap, boxes, box) ||
      free_share(gap, rays, s.cell) > s.most_free)
    return;
  thickness += gap.depth;
  box.centre = {box.centre.x - wall.normal.x * gap.depth / 2, box.centre.y - wall.normal.y * gap.depth / 2};
}

}  // namespace

void reach_walls(std::vector<MeasuredBox>& boxes, const std::vector<MeasuredWall>& walls,
                 const std::vector<SeenRay>& rays, const UnseenPartsSettings& settings) {
  if (rays.empty()) return;  // nothing tells what no photo shows
  for (MeasuredBox& box : boxes) {
    if (!is_one_of(kCases, box.class_name)) continue;
    for (const MeasuredWall& wall : walls) reach_wall(box, wall, boxes, rays, settings);
  }
}

bool can_hang_on_wall(const std::string& class_name) {
  return !is_one_of(kOnFloor, class_name) && class_name != "lamp";
}

void reach_down(std::vector<MeasuredBox>& boxes, const std::vector<SeenRay>& rays, const UnseenPartsSettings& s) {
  for (MeasuredBox& box : boxes) {
    if (box.support != "unknown") continue;
    if (is_one_of(kOnFloor, box.class_name)) box.bottom = 0;
    if (box.class_name != "lamp") continue;
    std::vector<double> below;
    for (const SeenRay& ray : rays) {
      if (ray.to.z < box.bottom && is_within(box, {ray.to.x, ray.to.y})) below.push_back(ray.to.z);
    }
    if (below.size() < std::max<size_t>(1, s.least_rays)) continue;
    constexpr double kLow = 0.1;  // share of the pixels below the surface: strays
    const double surface = quantile_of(below, kLow), middle = box.bottom - surface;
    // A pendant lamp has nothing between it and what is below.
    const auto foot = std::count_if(below.begin(), below.end(), [&](double z) {
      return z > surface + 0.25 * middle && z < surface + 0.75 * middle;
    });
    if (static_cast<double>(foot) < s.least_foot * static_cast<double>(below.size())) continue;
    box.bottom = surface < s.to_floor ? 0 : surface;
  }
}

}  // namespace aligngs
