#include "edit/fill/debris.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edit/fill/footprint.h"
#include "edit/fill/hidden_rows.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

/// Floor under the removed objects: photos saw it in their shade, if at all.
struct UnderObjects {
  Footprint footprint;
  std::vector<PlaneRectangle> outlines;  ///< of each object, in cells of the footprint; legs and all between them
  bool is_outlined(const Vec3d& place) const {
    return std::any_of(outlines.begin(), outlines.end(),
                       [&](const PlaneRectangle& o) { return o.holds(footprint.grid.place_of(place), 0); });
  }
};

UnderObjects under_objects(const FillRoom& r, const RoomPlane& plane) {
  UnderObjects out;
  std::vector<uint32_t> rows;
  std::vector<std::vector<uint32_t>> parts;
  for (const std::vector<uint8_t>& part : r.parts) {
    if (!r.rests_on(part, plane)) continue;
    parts.emplace_back();
    for (uint32_t i = 0; i < part.size(); ++i) {
      const double height = plane.height(position_of(r.room.model, i));
      if (part[i] && std::fabs(height) < r.settings.overhang * r.extent) parts.back().push_back(i);
    }
    rows.insert(rows.end(), parts.back().begin(), parts.back().end());
  }
  out.footprint = footprint_of(r.room.model, rows, plane, r.settings.cell_min * r.extent, r.settings.shadow);
  for (const std::vector<uint32_t>& part : parts) {
    if (part.size() >= FillRoom::kFewestCarriers) out.outlines.push_back(r.rectangle_on(out.footprint.grid, part));
  }
  return out;
}

/// The surface apart from the removed objects, with which their shade is compared.
Stains::Surface surface_around(const FillRoom& r, const RoomPlane& plane, const UnderObjects& under) {
  std::vector<uint32_t> apart = r.clean(plane.carriers, r.settings.shade);
  std::vector<uint32_t> rows;
  for (const uint32_t i : apart) {
    if (!under.is_outlined(position_of(r.room.model, i))) rows.push_back(i);
  }
  return r.stains.surface_of(rows.size() < FillRoom::kFewestCarriers ? std::move(apart) : std::move(rows));
}

/// Gaussians of a removed object that its selection leaves out. Those on walls, floor and ceiling stay unless their
/// colour is a stain there: they are of that surface.
std::vector<uint8_t> leftovers(const FillRoom& r) {
  std::vector<uint8_t> out(r.room.model.size(), 0);
  for (size_t i = 0; i < out.size(); ++i) {
    if (r.input.selected[i] || !r.taken.holds_row(i)) continue;
    const Vec3d place = position_of(r.room.model, i);
    out[i] =
        std::none_of(r.planes.begin(), r.planes.end(), [&](const RoomPlane& plane) { return r.lies_on(place, plane); });
  }
  return out;
}

const RoomPlane* nearest_plane(const FillRoom& r, const Vec3d& place, PlaneKind kind) {
  const RoomPlane* best = nullptr;
  double least = 1e300;
  for (const RoomPlane& plane : r.planes) {
    const double distance = std::fabs(plane.height(place));
    if (plane.kind != kind || distance >= least) continue;
    least = distance;
    best = &plane;
  }
  return best;
}

}  // namespace

std::vector<uint8_t> find_debris(const FillRoom& r) {
  std::vector<uint8_t> debris = leftovers(r);
  for (const RoomPlane& plane : r.planes) {
    const UnderObjects under = under_objects(r, plane);
    const Stains::Surface surface = surface_around(r, plane, under);
    r.for_each(debris.size(), [&](size_t i) {
      const uint16_t label = r.room.labels.label[i];
      if (r.input.selected[i] || debris[i] || label == kNoLabel || label >= r.classes.size()) return;
      const Vec3d place = position_of(r.room.model, i);
      const bool is_rug = r.classes[label].on_floor && plane.kind == PlaneKind::kFloor;
      if (is_rug && under.footprint.holds(place)) debris[i] = 1;
      // Crumbs of no object may lie on the surface, too: photos call the shade under an armchair armchair.
      const bool may_lie_there = r.taken.holds_row(i) || r.room.labels.instance[i] == 0;
      if (r.classes[label].shell != plane.kind && !(may_lie_there && r.lies_on(place, plane))) return;
      if (nearest_plane(r, place, plane.kind) != &plane) return;
      debris[i] = under.footprint.holds(place) || r.stains.is_stain(i, surface) ||
                  (under.is_outlined(place) && r.stains.is_shade(i, surface));
    });
  }
  mark_hidden_rows(r, debris);
  return debris;
}

}  // namespace aligngs
