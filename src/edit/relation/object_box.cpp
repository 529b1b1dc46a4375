#include "edit/relation/object_box.h"

#include <algorithm>

#include "core/perpendicular.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr double kBoxStrays = 0.02;   // share of the Gaussians below and above the box
constexpr size_t kMostPlaces = 2000;  // that are looked at: the directions of the footprint are many
constexpr size_t kFewestSolid = 8;    // below, faint Gaussians count, too

std::vector<uint32_t> rows_of_box(const GaussianModel& model, const std::vector<uint32_t>& rows) {
  std::vector<uint32_t> solid;
  for (const uint32_t i : rows) {
    if (opacity_of(model, i) >= kSolidOpacity) solid.push_back(i);
  }
  const std::vector<uint32_t>& all = solid.size() >= kFewestSolid ? solid : rows;
  const size_t step = all.size() / kMostPlaces + 1;
  std::vector<uint32_t> out;
  for (size_t k = 0; k < all.size(); k += step) out.push_back(all[k]);
  return out;
}

}  // namespace

BoxAxes::BoxAxes(const Vec3d& up_direction)
    : u(perpendicular_to(up_direction)), v(cross(up_direction, u)), up(up_direction) {}

double ObjectBox::volume(double thinnest) const {
  return std::max(length, thinnest) * std::max(width, thinnest) * std::max(height(), thinnest);
}

Vec2d ObjectBox::middle() const {
  const double x = 0.5 * (footprint.low[0] + footprint.high[0]), y = 0.5 * (footprint.low[1] + footprint.high[1]);
  const Vec2d& a = footprint.along;
  return {footprint.centre.x + a.x * x - a.y * y, footprint.centre.y + a.y * x + a.x * y};
}

ObjectBox object_box(const GaussianModel& model, const std::vector<uint32_t>& all, const BoxAxes& axes) {
  ObjectBox box;
  const std::vector<uint32_t> rows = rows_of_box(model, all);
  if (rows.empty()) return box;
  std::vector<Vec2d> places;
  std::vector<double> heights;
  for (const uint32_t i : rows) {
    const Vec3d p = position_of(model, i);
    places.push_back(axes.on_floor(p));
    heights.push_back(dot(axes.up, p));
  }
  box.footprint = rectangle_of(places);
  std::sort(heights.begin(), heights.end());
  const size_t cut = static_cast<size_t>(kBoxStrays * static_cast<double>(heights.size()));
  box.low = heights[cut];
  box.high = heights[heights.size() - 1 - cut];
  const double x = box.footprint.high[0] - box.footprint.low[0], y = box.footprint.high[1] - box.footprint.low[1];
  box.length = std::max(x, y);
  box.width = std::min(x, y);
  return box;
}

}  // namespace aligngs
