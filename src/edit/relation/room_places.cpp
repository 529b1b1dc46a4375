#include "edit/relation/room_places.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/quantile.h"

namespace aligngs {
namespace {

constexpr double kCorner = 0.8;         // metres to each of the two walls
constexpr double kSquare = 0.5;         // cosine: walls that meet in a corner
constexpr double kCornerStrays = 0.02;  // share of an object's places that may be nearer

}  // namespace

const std::vector<RoomPlane>& RoomPlaces::walls() const {
  if (walls_) return *walls_;
  const LabelledGaussians& room = objects_.room();
  const Vec3d inside = objects_.viewpoint().place.value_or(place_inside(room, {}));
  std::vector<RoomPlane> found;
  for (RoomPlane& plane :
       room_planes(room, carrying_classes(objects_.labels()), std::vector<uint8_t>(room.model.size(), 0), inside)) {
    if (plane.kind == PlaneKind::kWall) found.push_back(std::move(plane));
  }
  walls_ = std::make_unique<std::vector<RoomPlane>>(std::move(found));
  return *walls_;
}

std::optional<double> RoomPlaces::gap_to_corner(size_t object) const {
  if (walls().size() < 2)
    throw_bad_input({}, "--select", "the walls of this room are not known, so that no object is in a corner",
                    "name the object by its number: `aligngs edit RUN --list` shows them");
  const double reach = kCorner * objects_.metre();
  struct Near {
    const RoomPlane* wall;
    double gap;
  };
  std::vector<Near> near;
  for (const RoomPlane& wall : walls()) {
    std::vector<double> heights;
    for (const Vec3f& place : objects_.places(object)) {
      const Vec3d p = place.cast<double>();
      if (has_surface_at(wall, p, reach)) heights.push_back(wall.height(p));
    }
    if (heights.empty()) continue;
    const double gap = std::max(0.0, quantile_of(std::move(heights), kCornerStrays));
    if (gap <= reach) near.push_back({&wall, gap / objects_.metre()});
  }
  std::optional<double> least;
  for (size_t i = 0; i < near.size(); ++i) {
    for (size_t j = i + 1; j < near.size(); ++j) {
      if (std::fabs(dot(near[i].wall->normal, near[j].wall->normal)) > kSquare) continue;
      const double gap = std::hypot(near[i].gap, near[j].gap);
      if (!least || gap < *least) least = gap;
    }
  }
  return least;
}

double RoomPlaces::gap_to_middle(size_t object) const {
  std::vector<Vec2d> middles;
  size_t most = 0;
  Vec2d middle;
  for (size_t i = 0; i < objects_.size(); ++i) {
    const std::string& name = objects_.labels().classes.at(static_cast<size_t>(objects_[i].label)).name;
    if (name != "floor" || objects_[i].gaussians <= most) continue;
    most = objects_[i].gaussians;
    middle = objects_.box(i).middle();
  }
  if (most == 0)
    throw_bad_input({}, "--select", "the floor of this room is not known, so that nothing is in its middle",
                    "name the object by its number: `aligngs edit RUN --list` shows them");
  const Vec2d own = objects_.box(object).middle();
  return std::hypot(own.x - middle.x, own.y - middle.y) / objects_.metre();
}

}  // namespace aligngs
