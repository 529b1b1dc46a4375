#include "edit/fill/fill_room.h"

#include <algorithm>
#include <cmath>

#include "edit/support_fill.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/point_tree.h"

namespace aligngs {

FillRoom::FillRoom(const FillInput& given, const FillSettings& lengths)
    : input(given),
      settings(lengths),
      room(given.room),
      extent(given.room.extent),
      classes(carrying_classes(given.labels)),
      parts(connected_parts(given.room, given.selected)),
      hidden(given.room.model, given.selected, given.cameras, lengths.cube * given.room.extent),
      planes(room_planes(room, classes, given.selected, place_inside(room, given.cameras))),
      stains(room, points_of(given.selected), furniture_points(), lengths),
      taken(room.labels, given.selected),
      gone(given.selected) {}

void FillRoom::take_away(const std::vector<uint8_t>& debris) {
  for (size_t i = 0; i < gone.size(); ++i) gone[i] |= debris[i];
  for (RoomPlane& plane : planes) std::erase_if(plane.carriers, [&](uint32_t i) { return gone[i] != 0; });
}

std::vector<Vec3f> FillRoom::points_of(const std::vector<uint8_t>& rows) const {
  std::vector<Vec3f> points;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]) points.push_back(position_of(room.model, i).cast<float>());
  }
  return points;
}

std::vector<Vec3f> FillRoom::furniture_points() const {
  std::vector<Vec3f> points;
  for (const std::vector<uint8_t>& part : parts) {
    const bool rests =
        std::any_of(planes.begin(), planes.end(), [&](const RoomPlane& plane) { return rests_on(part, plane); });
    if (!rests) continue;
    const std::vector<Vec3f> more = points_of(part);
    points.insert(points.end(), more.begin(), more.end());
  }
  return points;
}

bool FillRoom::reaches(const std::vector<uint8_t>& part, const RoomPlane& plane, double distance) const {
  std::vector<double> heights;
  for (size_t i = 0; i < part.size(); ++i) {
    if (part[i]) heights.push_back(plane.height(position_of(room.model, i)));
  }
  constexpr double kLowest = 0.05;  // share of the part: strays below do not touch
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kLowest * static_cast<double>(heights.size()));
  std::nth_element(heights.begin(), low, heights.end());
  return !heights.empty() && *low < distance * extent;
}

bool FillRoom::rests_on(const std::vector<uint8_t>& part, const RoomPlane& plane) const {
  return plane.kind == PlaneKind::kFloor && reaches(part, plane, settings.overhang);
}

std::vector<uint32_t> FillRoom::clean(const std::vector<uint32_t>& carriers, double halo) const {
  std::vector<uint8_t> apart(carriers.size(), 0);
  for_each(carriers.size(), [&](size_t k) {
    const Vec3d place = position_of(room.model, carriers[k]);
    apart[k] = !stains.is_beside(place, halo) &&
               (input.cameras.empty() || !stains.is_beside(place, settings.unsure) || hidden.is_shown(place));
  });
  std::vector<uint32_t> out;
  for (size_t k = 0; k < carriers.size(); ++k) {
    if (apart[k]) out.push_back(carriers[k]);
  }
  return out.size() < kFewestCarriers ? carriers : out;
}

double FillRoom::cell_of(const std::vector<uint32_t>& carriers) const {
  std::vector<Vec3f> points;
  for (const uint32_t i : carriers) points.push_back(position_of(room.model, i).cast<float>());
  const PointTree tree(points);
  std::vector<float> spacing(points.size());
  for_each(points.size(), [&](size_t k) {
    std::vector<PointTree::Neighbour> near;
    tree.nearest(points[k], 2, near);
    spacing[k] = near.back().distance;
  });
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  return std::clamp<double>(*middle, settings.cell_min * extent, settings.cell_max * extent);
}

std::vector<uint32_t> FillRoom::rows_on(const PlaneGrid& grid, int label, int instance, double tolerance) const {
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < room.model.size(); ++i) {
    if (gone[i] || room.labels.label[i] != label || room.labels.instance[i] != instance) continue;
    if (std::fabs(grid.height_of(position_of(room.model, i))) < tolerance * extent) rows.push_back(i);
  }
  return rows;
}

bool FillRoom::lies_on(const Vec3d& place, const RoomPlane& plane) const {
  return std::fabs(plane.height(place)) < settings.tolerance * extent;
}

std::vector<float> FillRoom::coverage(const PlaneGrid& grid, bool is_gone) const {
  std::vector<float> cover(grid.size(), 0.f);
  const double tolerance = 2 * settings.tolerance * extent;
  for (size_t i = 0; i < room.model.size(); ++i) {
    if ((gone[i] != 0) == is_gone && std::fabs(grid.height_of(position_of(room.model, i))) < tolerance)
      splat(room.model, i, grid, false, cover);
  }
  return cover;
}

void FillRoom::splat_part(const std::vector<uint8_t>& part, const PlaneGrid& grid, std::vector<float>& cover) const {
  for (size_t i = 0; i < part.size(); ++i) {
    if (part[i]) splat(room.model, i, grid, true, cover);
  }
}

PlaneRectangle FillRoom::rectangle_on(const PlaneGrid& grid, const std::vector<uint32_t>& rows) const {
  std::vector<Vec2d> places;
  for (const uint32_t i : rows) places.push_back(grid.place_of(position_of(room.model, i)));
  return rectangle_of(places);
}

}  // namespace aligngs
