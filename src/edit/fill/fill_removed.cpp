#include "edit/fill/fill_removed.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "edit/fill/debris.h"
#include "edit/fill/fill_room.h"
#include "edit/fill/furniture_fill.h"
#include "edit/fill/grid_regions.h"
#include "edit/fill/hole_gaps.h"
#include "edit/fill/lifted_shade.h"
#include "edit/fill/plane_rectangle.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

/// Places of windows and doors in a wall.
std::vector<float> opened(const FillRoom& r, const PlaneGrid& grid) {
  std::vector<int> openings;
  for (const char* name : {"windowpane", "door", "screen door"}) openings.push_back(r.input.labels.find(name));
  std::vector<float> cover(grid.size(), 0.f);
  for (size_t i = 0; i < r.room.model.size(); ++i) {
    const int label = r.room.labels.label[i];
    if (r.gone[i] || std::find(openings.begin(), openings.end(), label) == openings.end()) continue;
    if (std::fabs(grid.height_of(position_of(r.room.model, i))) < r.settings.opening * r.extent)
      splat(r.room.model, i, grid, true, cover);
  }
  return cover;
}

/// The hole and the thin rim of the surface around it, through which the black behind the room would show.
std::vector<uint8_t> with_seam(const FillRoom& r, const PlaneGrid& grid, const std::vector<float>& cover,
                               const std::vector<uint8_t>& barred, const std::vector<uint8_t>& hole) {
  std::vector<uint8_t> wide = grown(hole, grid, 2);
  for (size_t at = 0; at < wide.size(); ++at)
    wide[at] = hole[at] || (wide[at] && cover[at] < r.settings.thin && !barred[at]);
  return wide;
}

void add_hole(const FillRoom& r, const PlaneGrid& grid, std::vector<uint8_t> cells,
              const std::vector<uint32_t>& carriers, bool is_floor, std::vector<SurfaceHole>& holes) {
  SurfaceHole hole{grid, std::move(cells), {}, is_floor};
  if (hole.is_empty()) return;
  hole.carriers = r.clean(carriers, r.settings.halo);
  holes.push_back(std::move(hole));
}

/// The hole of a shell plane, divided among the surface itself and the rugs on it.
std::vector<SurfaceHole> holes_of(const FillRoom& r, const RoomPlane& plane, const PlaneGrid& grid,
                                  std::vector<uint8_t> hole) {
  std::vector<SurfaceHole> holes;
  if (plane.kind == PlaneKind::kFloor) {
    for (const Instance& rug : list_instances(r.room.model, r.room.labels)) {
      if (!r.classes[static_cast<size_t>(rug.label)].on_floor) continue;
      // The remains of a rug that goes are no rug.
      if (r.taken.holds(static_cast<uint16_t>(rug.label), static_cast<uint16_t>(rug.number))) continue;
      const std::vector<uint32_t> rows = r.rows_on(grid, rug.label, rug.number, 2 * r.settings.tolerance);
      if (rows.size() < FillRoom::kFewestCarriers) continue;
      const PlaneRectangle rectangle = r.rectangle_on(grid, rows);
      std::vector<uint8_t> part(hole.size(), 0);
      for (int j = 0; j < grid.rows; ++j) {
        for (int i = 0; i < grid.columns; ++i) {
          const size_t at = grid.index(i, j);
          if (!hole[at] || !rectangle.holds({i + 0.5, j + 0.5}, 0)) continue;
          part[at] = 1;
          hole[at] = 0;
        }
      }
      add_hole(r, grid, std::move(part), rows, false, holes);
    }
  }
  add_hole(r, grid, std::move(hole), plane.carriers, plane.kind == PlaneKind::kFloor, holes);
  return holes;
}

/// A surface of the shell continues where the object touched it, and where it hid it from most photos.
std::vector<SurfaceHole> shell_holes(const FillRoom& r, const RoomPlane& plane) {
  std::vector<Vec3d> points;
  for (const uint32_t i : plane.carriers) points.push_back(position_of(r.room.model, i));
  std::vector<const std::vector<uint8_t>*> touching;
  for (const std::vector<uint8_t>& part : r.parts) {
    const bool touches = r.reaches(part, plane, r.settings.touch);
    if (touches) touching.push_back(&part);
    // A wall that only its upper half shows goes on down to the foot of what hid it.
    if (!touches && !r.reaches(part, plane, r.settings.behind)) continue;
    for (size_t i = 0; i < part.size(); ++i) {
      if (part[i]) points.push_back(position_of(r.room.model, i));
    }
  }
  const double cell = r.cell_of(plane.carriers);
  const PlaneGrid grid = grid_over(points, plane, cell, 2 * cell);
  const std::vector<float> cover = r.coverage(grid, false), lost = r.coverage(grid, true);
  const std::vector<float> open =
      plane.kind == PlaneKind::kWall ? opened(r, grid) : std::vector<float>(grid.size(), 0.f);
  std::vector<float> object(grid.size(), 0.f);
  for (const std::vector<uint8_t>* part : touching) r.splat_part(*part, grid, object);
  const double tolerance = r.settings.tolerance * r.extent;
  std::vector<uint8_t> hole(grid.size(), 0), closed(grid.size(), 0), barred(grid.size(), 0);
  r.for_each(
      static_cast<size_t>(grid.rows),
      [&](size_t row) {
        const int j = static_cast<int>(row);
        for (int i = 0; i < grid.columns; ++i) {
          const size_t at = grid.index(i, j);
          closed[at] = cover[at] >= r.settings.covered;
          if (cover[at] >= r.settings.thin) continue;  // neither the hole nor its rim
          const Vec3d place = grid.at(i + 0.5, j + 0.5);
          barred[at] =
              open[at] > r.settings.shadow || !is_inside(place, r.planes, tolerance, r.settings.opening * r.extent);
          closed[at] |= barred[at];
          if (closed[at]) continue;
          hole[at] = object[at] > r.settings.shadow || lost[at] > r.settings.shadow || r.hidden.from_most(place);
        }
      },
      1);
  const double gap = r.settings.gap * r.extent / grid.cell;
  close_gaps(grid, closed, static_cast<size_t>(gap * gap), hole);
  return holes_of(r, plane, grid, with_seam(r, grid, cover, barred, hole));
}

/// Copies of the rows that are lighter now. They replace the rows.
void add_lighter(const FillRoom& r, const std::vector<Vec3f>& gains, Filling& filling) {
  constexpr float kLeastGain = 0.01f;  // nobody sees less
  filling.shaded.assign(r.room.model.size(), 0);
  filling.lighter.gaussians.semantic_channels = r.room.model.semantic_channels;
  filling.lighter.gaussians.sh_degree = r.room.model.sh_degree;
  for (uint32_t i = 0; i < gains.size(); ++i) {
    if (r.gone[i] || norm(gains[i] - Vec3f{1, 1, 1}) < kLeastGain) continue;
    filling.shaded[i] = 1;
    add_lifted(r.room, i, gains[i], filling.lighter);
  }
}

}  // namespace

Filling fill_removed(const FillInput& input, const FillSettings& settings) {
  FillRoom room(input, settings);
  Filling filling;
  filling.debris = find_debris(room);
  room.take_away(filling.debris);
  const std::vector<Vec3f> gains = lifted_shade(room);
  std::vector<SurfaceHole> holes;
  const auto add = [&](std::vector<SurfaceHole> more) {
    holes.insert(holes.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  for (const RoomPlane& plane : room.planes) {
    if (plane.carriers.size() >= FillRoom::kFewestCarriers) add(shell_holes(room, plane));
  }
  for (const std::vector<uint8_t>& part : room.parts) add(furniture_holes(room, part));
  filling.patches.resize(holes.size());
  room.for_each(
      holes.size(), [&](size_t k) { filling.patches[k] = make_patch(room.room, holes[k], gains); }, 1);
  std::erase_if(filling.patches, [](const SupportPatch& p) { return p.sources.empty(); });
  add_lighter(room, gains, filling);
  return filling;
}

}  // namespace aligngs
