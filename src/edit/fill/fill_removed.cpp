#include "edit/fill/fill_removed.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "edit/fill/carrying_classes.h"
#include "edit/fill/footprint.h"
#include "edit/fill/hidden_places.h"
#include "edit/fill/hole_gaps.h"
#include "edit/fill/plane_rectangle.h"
#include "edit/fill/room_planes.h"
#include "edit/fill/stains.h"
#include "edit/support_fill.h"
#include "edit/taken_objects.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

constexpr size_t kFewestCarriers = 12;  ///< Gaussians that make a surface believable

/// The room, what goes, and all that filling asks of both.
class Filler {
 public:
  Filler(const FillInput& input, const FillSettings& settings)
      : input_(input),
        settings_(settings),
        room_(input.room),
        extent_(input.room.extent),
        classes_(carrying_classes(input.labels)),
        parts_(connected_parts(input.room, input.selected)),
        hidden_(input.room.model, input.selected, input.cameras, settings.cube * input.room.extent),
        planes_(room_planes(room_, classes_, input_.selected, place_inside(room_, input_.cameras))),
        stains_(room_, points_of(input.selected), furniture_points(), settings),
        taken_(room_.labels, input.selected) {
    gone_ = input_.selected;
    for (const char* name : {"windowpane", "door", "screen door"}) openings_.push_back(input.labels.find(name));
  }

  Filling run() {
    Filling filling;
    filling.debris = find_debris();
    for (size_t i = 0; i < gone_.size(); ++i) gone_[i] |= filling.debris[i];
    for (RoomPlane& plane : planes_) std::erase_if(plane.carriers, [&](uint32_t i) { return gone_[i] != 0; });
    std::vector<SupportPatch>& patches = filling.patches;
    for (const RoomPlane& plane : planes_) {
      if (plane.carriers.size() < kFewestCarriers) continue;
      for (SupportPatch& patch : fill_shell(plane)) patches.push_back(std::move(patch));
    }
    for (const std::vector<uint8_t>& part : parts_) {
      for (SupportPatch& patch : fill_furniture(part)) patches.push_back(std::move(patch));
    }
    std::erase_if(patches, [](const SupportPatch& p) { return p.sources.empty(); });
    return filling;
  }

 private:
  /// In parallel where there is a pool. The body of an index writes for that index alone.
  template <class Body>
  void for_each(size_t count, const Body& body, size_t grain = 256) const {
    const auto chunk = [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) body(i);
    };
    if (input_.pool)
      input_.pool->parallel_for(count, grain, chunk);
    else
      chunk(0, count, 0);
  }
  std::vector<Vec3f> points_of(const std::vector<uint8_t>& rows) const {
    std::vector<Vec3f> points;
    for (size_t i = 0; i < rows.size(); ++i) {
      if (rows[i]) points.push_back(position_of(room_.model, i).cast<float>());
    }
    return points;
  }
  std::vector<Vec3f> furniture_points() const {
    std::vector<Vec3f> points;
    for (const std::vector<uint8_t>& part : parts_) {
      const bool rests =
          std::any_of(planes_.begin(), planes_.end(), [&](const RoomPlane& plane) { return rests_on(part, plane); });
      if (!rests) continue;
      const std::vector<Vec3f> more = points_of(part);
      points.insert(points.end(), more.begin(), more.end());
    }
    return points;
  }
  /// A part reaches a plane to within a share of the extent.
  bool reaches(const std::vector<uint8_t>& part, const RoomPlane& plane, double distance) const {
    std::vector<double> heights;
    for (size_t i = 0; i < part.size(); ++i) {
      if (part[i]) heights.push_back(dot(plane.normal, position_of(room_.model, i)) - plane.offset);
    }
    constexpr double kLowest = 0.05;  // share of the part: strays below do not touch
    const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kLowest * static_cast<double>(heights.size()));
    std::nth_element(heights.begin(), low, heights.end());
    return !heights.empty() && *low < distance * extent_;
  }
  /// Furniture, also where nobody saw its legs.
  bool rests_on(const std::vector<uint8_t>& part, const RoomPlane& plane) const {
    return plane.kind == PlaneKind::kFloor && reaches(part, plane, settings_.overhang);
  }
  /// Carriers of a surface farther from the removed object than a share of the extent, where enough are.
  std::vector<uint32_t> clean(const std::vector<uint32_t>& carriers, double halo) const {
    std::vector<uint8_t> apart(carriers.size(), 0);
    for_each(carriers.size(),
             [&](size_t k) { apart[k] = !stains_.is_beside(position_of(room_.model, carriers[k]), halo); });
    std::vector<uint32_t> out;
    for (size_t k = 0; k < carriers.size(); ++k) {
      if (apart[k]) out.push_back(carriers[k]);
    }
    return out.size() < kFewestCarriers ? carriers : out;
  }
  double cell_of(const std::vector<uint32_t>& carriers) const {
    std::vector<Vec3f> points;
    for (const uint32_t i : carriers) points.push_back(position_of(room_.model, i).cast<float>());
    const PointTree tree(points);
    std::vector<float> spacing(points.size());
    for_each(points.size(), [&](size_t k) {
      std::vector<PointTree::Neighbour> near;
      tree.nearest(points[k], 2, near);
      spacing[k] = near.back().distance;
    });
    const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
    std::nth_element(spacing.begin(), middle, spacing.end());
    return std::clamp<double>(*middle, settings_.cell_min * extent_, settings_.cell_max * extent_);
  }
  /// Opacity of what stays on a plane, or with `gone` of what goes from it.
  std::vector<float> coverage(const PlaneGrid& grid, bool gone) const {
    std::vector<float> cover(grid.size(), 0.f);
    const double tolerance = 2 * settings_.tolerance * extent_;
    for (size_t i = 0; i < room_.model.size(); ++i) {
      if ((gone_[i] != 0) == gone && std::fabs(grid.height_of(position_of(room_.model, i))) < tolerance)
        splat(room_.model, i, grid, false, cover);
    }
    return cover;
  }
  /// Places of windows and doors in a wall.
  std::vector<float> opened(const PlaneGrid& grid) const {
    std::vector<float> cover(grid.size(), 0.f);
    for (size_t i = 0; i < room_.model.size(); ++i) {
      const int label = room_.labels.label[i];
      if (gone_[i] || std::find(openings_.begin(), openings_.end(), label) == openings_.end()) continue;
      if (std::fabs(grid.height_of(position_of(room_.model, i))) < settings_.opening * extent_)
        splat(room_.model, i, grid, true, cover);
    }
    return cover;
  }
  /// Floor under the removed objects: photos saw it in their shade, if at all.
  Footprint footprint(const RoomPlane& plane) const {
    std::vector<uint32_t> rows;
    for (const std::vector<uint8_t>& part : parts_) {
      if (!rests_on(part, plane)) continue;
      for (uint32_t i = 0; i < part.size(); ++i) {
        const double height = dot(plane.normal, position_of(room_.model, i)) - plane.offset;
        if (part[i] && std::fabs(height) < settings_.overhang * extent_) rows.push_back(i);
      }
    }
    return footprint_of(room_.model, rows, plane, settings_.cell_min * extent_, settings_.shadow);
  }
  std::vector<uint8_t> find_debris() const {
    std::vector<uint8_t> debris = leftovers();
    for (const RoomPlane& plane : planes_) {
      const Stains::Surface surface = stains_.surface_of(clean(plane.carriers, settings_.shade));
      const Footprint under = footprint(plane);
      for_each(debris.size(), [&](size_t i) {
        const uint16_t label = room_.labels.label[i];
        if (input_.selected[i] || debris[i] || label == kNoLabel || label >= classes_.size()) return;
        const Vec3d place = position_of(room_.model, i);
        if (classes_[label].shell != plane.kind && !(taken_.holds_row(i) && lies_on(place, plane))) return;
        if (nearest_plane(place, plane.kind) != &plane) return;
        debris[i] = under.holds(place) || stains_.is_stain(i, surface) || hidden_.from_all(place);
      });
    }
    return debris;
  }
  bool lies_on(const Vec3d& place, const RoomPlane& plane) const {
    return std::fabs(dot(plane.normal, place) - plane.offset) < settings_.tolerance * extent_;
  }
  /// Gaussians of a removed object that its selection leaves out. Those on walls, floor and ceiling stay unless their
  /// colour is a stain there: they are of that surface.
  std::vector<uint8_t> leftovers() const {
    std::vector<uint8_t> out(room_.model.size(), 0);
    for (size_t i = 0; i < out.size(); ++i) {
      if (input_.selected[i] || !taken_.holds_row(i)) continue;
      const Vec3d place = position_of(room_.model, i);
      out[i] =
          std::none_of(planes_.begin(), planes_.end(), [&](const RoomPlane& plane) { return lies_on(place, plane); });
    }
    return out;
  }
  const RoomPlane* nearest_plane(const Vec3d& place, PlaneKind kind) const {
    const RoomPlane* best = nullptr;
    double least = 1e300;
    for (const RoomPlane& plane : planes_) {
      const double distance = std::fabs(dot(plane.normal, place) - plane.offset);
      if (plane.kind != kind || distance >= least) continue;
      least = distance;
      best = &plane;
    }
    return best;
  }
  std::vector<SupportPatch> fill_shell(const RoomPlane& plane) const {
    std::vector<Vec3d> points;
    for (const uint32_t i : plane.carriers) points.push_back(position_of(room_.model, i));
    std::vector<const std::vector<uint8_t>*> touching;
    for (const std::vector<uint8_t>& part : parts_) {
      if (!reaches(part, plane, settings_.touch)) continue;
      touching.push_back(&part);
      for (size_t i = 0; i < part.size(); ++i) {
        if (part[i]) points.push_back(position_of(room_.model, i));
      }
    }
    const double cell = cell_of(plane.carriers);
    const PlaneGrid grid = grid_over(points, plane, cell, 2 * cell);
    const std::vector<float> cover = coverage(grid, false), lost = coverage(grid, true);
    const std::vector<float> open =
        plane.kind == PlaneKind::kWall ? opened(grid) : std::vector<float>(grid.size(), 0.f);
    std::vector<float> object(grid.size(), 0.f);
    for (const std::vector<uint8_t>* part : touching) {
      for (size_t i = 0; i < part->size(); ++i) {
        if ((*part)[i]) splat(room_.model, i, grid, true, object);
      }
    }
    const double tolerance = settings_.tolerance * extent_;
    std::vector<uint8_t> hole(grid.size(), 0), closed(grid.size(), 0), barred(grid.size(), 0);
    for_each(
        static_cast<size_t>(grid.rows),
        [&](size_t row) {
          const int j = static_cast<int>(row);
          for (int i = 0; i < grid.columns; ++i) {
            const size_t at = grid.index(i, j);
            closed[at] = cover[at] >= settings_.covered;
            if (cover[at] >= settings_.thin) continue;  // neither the hole nor its rim
            const Vec3d place = grid.at(i + 0.5, j + 0.5);
            barred[at] =
                open[at] > settings_.shadow || !is_inside(place, planes_, tolerance, settings_.opening * extent_);
            closed[at] |= barred[at];
            if (closed[at]) continue;
            hole[at] = object[at] > settings_.shadow || lost[at] > settings_.shadow || hidden_.from_most(place);
          }
        },
        1);
    const double gap = settings_.gap * extent_ / grid.cell;
    close_gaps(grid, closed, static_cast<size_t>(gap * gap), hole);
    return patches_of(plane, grid, with_seam(grid, cover, barred, hole));
  }

  /// The hole and the thin rim of the surface around it, through which the black behind the room would show.
  std::vector<uint8_t> with_seam(const PlaneGrid& grid, const std::vector<float>& cover,
                                 const std::vector<uint8_t>& barred, const std::vector<uint8_t>& hole) const {
    std::vector<uint8_t> wide = widened(widened(hole, grid), grid);
    for (size_t at = 0; at < wide.size(); ++at)
      wide[at] = hole[at] || (wide[at] && cover[at] < settings_.thin && !barred[at]);
    return wide;
  }

  /// The hole of a shell plane, divided among the surface itself and the rugs on it.
  std::vector<SupportPatch> patches_of(const RoomPlane& plane, const PlaneGrid& grid, std::vector<uint8_t> hole) const {
    std::vector<SupportPatch> patches;
    if (plane.kind == PlaneKind::kFloor) {
      for (const Instance& rug : list_instances(room_.model, room_.labels)) {
        if (!classes_[static_cast<size_t>(rug.label)].on_floor) continue;
        // The remains of a rug that goes are no rug.
        if (taken_.holds(static_cast<uint16_t>(rug.label), static_cast<uint16_t>(rug.number))) continue;
        const std::vector<uint32_t> rows = rows_on(grid, rug.label, rug.number, 2 * settings_.tolerance);
        if (rows.size() < kFewestCarriers) continue;
        std::vector<Vec2d> places;
        for (const uint32_t i : rows) places.push_back(grid.place_of(position_of(room_.model, i)));
        const PlaneRectangle rectangle = rectangle_of(places);
        std::vector<uint8_t> part(hole.size(), 0);
        for (int j = 0; j < grid.rows; ++j) {
          for (int i = 0; i < grid.columns; ++i) {
            const size_t at = grid.index(i, j);
            if (!hole[at] || !rectangle.holds({i + 0.5, j + 0.5}, 0)) continue;
            part[at] = 1;
            hole[at] = 0;
          }
        }
        patches.push_back(make_patch(room_, grid, part, clean(rows, settings_.halo)));
      }
    }
    patches.push_back(make_patch(room_, grid, hole, clean(plane.carriers, settings_.halo)));
    return patches;
  }

  /// Rows of an object that lie on a plane; `tolerance` is a share of the extent.
  std::vector<uint32_t> rows_on(const PlaneGrid& grid, int label, int instance, double tolerance) const {
    std::vector<uint32_t> rows;
    for (uint32_t i = 0; i < room_.model.size(); ++i) {
      if (gone_[i] || room_.labels.label[i] != label || room_.labels.instance[i] != instance) continue;
      if (std::fabs(grid.height_of(position_of(room_.model, i))) < tolerance * extent_) rows.push_back(i);
    }
    return rows;
  }

  std::vector<SupportPatch> fill_furniture(const std::vector<uint8_t>& part) const {
    std::vector<uint8_t> candidates(room_.model.size(), 0);
    for (size_t i = 0; i < candidates.size(); ++i) {
      const uint16_t label = room_.labels.label[i];
      candidates[i] = label != kNoLabel && label < classes_.size() && classes_[label].furniture;
    }
    std::vector<SupportPatch> patches;
    for (const SupportPlane& plane : find_supports(room_, part, input_.selected, candidates, input_.up)) {
      // The furniture that most of the carriers are of.
      std::map<std::pair<uint16_t, uint16_t>, size_t> votes;
      for (const uint32_t i : plane.carriers) ++votes[{room_.labels.label[i], room_.labels.instance[i]}];
      const auto [label, instance] = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                                       return a.second < b.second;
                                     })->first;
      std::vector<Vec3d> points;
      for (size_t i = 0; i < part.size(); ++i) {
        if (part[i]) points.push_back(position_of(room_.model, i));
      }
      const double cell = cell_of(plane.carriers);
      constexpr int kBorder = 12;  // cells around the object whose colours are continued
      const PlaneGrid grid = grid_over(points, {plane.normal, plane.offset}, cell, kBorder * cell);
      const std::vector<uint32_t> rows = rows_on(grid, label, instance, settings_.tolerance);
      std::vector<Vec2d> places;
      for (const uint32_t i : rows) places.push_back(grid.place_of(position_of(room_.model, i)));
      if (places.size() < kFewestCarriers) continue;
      const PlaneRectangle bounds = rectangle_of(places);
      std::vector<float> object(grid.size(), 0.f);
      for (size_t i = 0; i < part.size(); ++i) {
        if (part[i]) splat(room_.model, i, grid, true, object);
      }
      const std::vector<float> cover = coverage(grid, false);
      std::vector<uint8_t> hole(grid.size(), 0);
      for (int j = 0; j < grid.rows; ++j) {
        for (int i = 0; i < grid.columns; ++i) {
          const size_t at = grid.index(i, j);
          hole[at] =
              object[at] > settings_.shadow && cover[at] < settings_.covered && bounds.holds({i + 0.5, j + 0.5}, 1);
        }
      }
      patches.push_back(make_patch(room_, grid, hole, clean(rows, settings_.halo)));
    }
    return patches;
  }

  const FillInput& input_;
  const FillSettings& settings_;
  const LabelledGaussians& room_;
  double extent_;
  std::vector<CarryingClass> classes_;
  std::vector<std::vector<uint8_t>> parts_;
  HiddenPlaces hidden_;
  std::vector<RoomPlane> planes_;
  Stains stains_;
  TakenObjects taken_;
  std::vector<uint8_t> gone_;  ///< selected, and debris
  std::vector<int> openings_;  ///< classes
};

}  // namespace

Filling fill_removed(const FillInput& input, const FillSettings& settings) { return Filler(input, settings).run(); }

}  // namespace aligngs
