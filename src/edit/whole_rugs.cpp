#include "edit/whole_rugs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/quantile.h"
#include "edit/fill/carrying_classes.h"
#include "edit/fill/grid_regions.h"
#include "edit/fill/plane_rectangle.h"
#include "edit/fill/room_planes.h"
#include "edit/floor_picture.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

constexpr double kFewOfAColor = 0.002;  ///< share of cells that is added to each colour: rare ones tell nothing
constexpr int kLikenessReach = 2;       ///< cells: likeness is a mean over a square, since patterns alternate
constexpr double kLikely = 0.5, kStillLikely = 0.3;  ///< likeness of new cells of a rug, and of those with its label
/// Share of the best extent's score: inner frames of a pattern may fit a little better than the whole.
constexpr double kAsGood = 0.9;
constexpr double kLeastFar = 0.1;  ///< share of the floor's cells that must be far from the rug

using RugKey = std::pair<uint16_t, uint16_t>;  ///< class and number

/// One rug, and how far it may reach.
class RugGrowth {
 public:
  RugGrowth(const FloorPicture& picture, CellRegion labelled, double extent, const WholeRugOptions& options)
      : picture_(picture),
        labelled_(std::move(labelled)),
        options_(options),
        seen_(picture.grid, picture.seen),
        around_seen_(grown(picture.seen, picture.grid, 1)) {
    const auto cells = [&](double share) {
      return std::max(1, static_cast<int>(std::lround(share * extent / picture.grid.cell)));
    };
    apart_ = cells(options.apart);
    step_ = cells(options.step);
    close_ = cells(options.close);
    beside_ = cells(options.beside);
  }

  /// The extent of the whole rug; empty where the labels' own is as good.
  std::optional<CellRegion> whole() const {
    if (count_of(labelled_) < options_.seeds) return std::nullopt;
    const double filled = filled_share(labelled_);
    if (filled >= options_.whole) return std::nullopt;
    const double least = options_.better * filled * contrast(labelled_);
    std::vector<std::pair<double, CellRegion>> good;
    double most = 0;
    CellRegion region = labelled_;
    for (int round = 0; round < options_.rounds; ++round) {
      std::optional<CellRegion> next = grown_once(region);
      if (!next || *next == region) break;
      region = std::move(*next);
      const double share = filled_share(region), edge = contrast(region), score = share * edge;
      if (share < options_.whole || edge < options_.contrast || score <= least) continue;
      most = std::max(most, score);
      good.push_back({score, region});
    }
    while (!good.empty() && good.back().first < kAsGood * most) good.pop_back();
    if (good.empty()) return std::nullopt;
    return std::move(good.back().second);
  }

 private:
  static size_t count_of(const CellRegion& region) {
    return static_cast<size_t>(std::count(region.begin(), region.end(), uint8_t(1)));
  }

  /// Share of the cells that photos see within the rectangle around the region.
  double filled_share(const CellRegion& region) const {
    const CellRegion rim = rim_of(region, picture_.grid);
    std::vector<Vec2d> places;
    visit(rim, [&](int column, int row, size_t) { places.push_back({column + 0.5, row + 0.5}); });
    if (places.size() < 3) return 0;
    const PlaneRectangle rectangle = rectangle_of(places);
    size_t all = 0, filled = 0;
    visit(picture_.seen, [&](int column, int row, size_t cell) {
      if (!rectangle.holds({column + 0.5, row + 0.5}, 0.5)) return;
      ++all;
      filled += region[cell];
    });
    return all > 0 ? static_cast<double>(filled) / static_cast<double>(all) : 0;
  }

  /// Median over the edge to floor that is seen: the distance of the mean colours on both sides.
  double contrast(const CellRegion& region) const {
    constexpr size_t kFewestCells = 20;  // of the edge
    constexpr double kFewestBeside = 8;  // cells on either side
    CellRegion outside(region.size()), inside(region.size());
    for (size_t i = 0; i < region.size(); ++i) {
      inside[i] = region[i] && picture_.seen[i];
      outside[i] = !region[i] && picture_.seen[i];
    }
    const CellRegion near = grown(outside, picture_.grid, 2);
    const std::array<SquareSums, 4> in = sums_over(inside), out = sums_over(outside);
    std::vector<double> steps;
    visit(inside, [&](int column, int row, size_t cell) {
      if (!near[cell]) return;
      const double cells_in = in[3].around(column, row, beside_), cells_out = out[3].around(column, row, beside_);
      if (cells_in <= kFewestBeside || cells_out <= kFewestBeside) return;
      Vec3d step;
      for (int c = 0; c < 3; ++c) {
        const size_t channel = static_cast<size_t>(c);
        step[c] =
            in[channel].around(column, row, beside_) / cells_in - out[channel].around(column, row, beside_) / cells_out;
      }
      steps.push_back(norm(step));
    });
    return steps.size() < kFewestCells ? 0 : quantile_of(std::move(steps), 0.5);
  }

  /// Sums of the three channels over some cells, and their number.
  std::array<SquareSums, 4> sums_over(const CellRegion& cells) const {
    const auto channel = [&](size_t c) {
      std::vector<float> values(cells.size());
      for (size_t i = 0; i < cells.size(); ++i) values[i] = cells[i] ? picture_.color[c][i] : 0.0f;
      return SquareSums(picture_.grid, values);
    };
    return {channel(0), channel(1), channel(2), SquareSums(picture_.grid, cells)};
  }

  /// The region with floor beside it that is more like the region than like floor far away; empty without such floor.
  std::optional<CellRegion> grown_once(const CellRegion& region) const {
    const CellRegion beside = grown(region, picture_.grid, apart_);
    std::vector<double> here(kFloorColors, 0), far(kFloorColors, 0);
    size_t cells_here = 0, cells_far = 0;
    visit(picture_.seen, [&](int, int, size_t cell) {
      if (region[cell]) {
        ++here[picture_.shade[cell]];
        ++cells_here;
      } else if (!beside[cell]) {
        ++far[picture_.shade[cell]];
        ++cells_far;
      }
    });
    if (cells_here == 0 || static_cast<double>(cells_far) < kLeastFar * static_cast<double>(count_of(picture_.seen)))
      return std::nullopt;
    std::vector<float> likeness(picture_.seen.size(), 0);
    visit(picture_.seen, [&](int, int, size_t cell) {
      const double a = here[picture_.shade[cell]] / static_cast<double>(cells_here) + kFewOfAColor,
                   b = far[picture_.shade[cell]] / static_cast<double>(cells_far) + kFewOfAColor;
      likeness[cell] = static_cast<float>(a / (a + b));
    });
    const SquareSums sums(picture_.grid, likeness);
    const CellRegion near = grown(region, picture_.grid, step_);
    CellRegion next(region.size(), 0);
    visit(picture_.seen, [&](int column, int row, size_t cell) {
      const double mean = sums.around(column, row, kLikenessReach) / seen_.around(column, row, kLikenessReach);
      next[cell] = (near[cell] && mean > kLikely) || (labelled_[cell] && mean > kStillLikely);
    });
    next = without_holes(closed(next, picture_.grid, close_), picture_.grid);
    for (size_t i = 0; i < next.size(); ++i) next[i] = next[i] && around_seen_[i];
    return connected_to(labelled_, next, picture_.grid);
  }

  /// Calls take(column, row, index) for the cells of a region.
  template <class Take>
  void visit(const CellRegion& region, const Take& take) const {
    for (int row = 0; row < picture_.grid.rows; ++row) {
      for (int column = 0; column < picture_.grid.columns; ++column) {
        const size_t cell = picture_.grid.index(column, row);
        if (region[cell]) take(column, row, cell);
      }
    }
  }

  const FloorPicture& picture_;
  CellRegion labelled_;
  const WholeRugOptions& options_;
  SquareSums seen_;
  CellRegion around_seen_;
  int apart_ = 1, step_ = 1, close_ = 1, beside_ = 1;  ///< cells
};

/// Cells with a Gaussian of a rug, and the gaps of the picture among them.
CellRegion without_gaps(const CellRegion& labelled, const FloorPicture& picture) {
  constexpr int kGapReach = 2;  // cells
  CellRegion out = closed(labelled, picture.grid, kGapReach);
  for (size_t i = 0; i < out.size(); ++i) out[i] = out[i] && picture.seen[i];
  return out;
}

/// The plane of the floor with the most Gaussians.
std::optional<RoomPlane> largest_floor(const LabelledGaussians& room, std::vector<CarryingClass> classes,
                                       const std::vector<Camera>& cameras) {
  for (CarryingClass& c : classes) {
    if (c.shell != PlaneKind::kFloor) c = {};  // no other plane is looked for
  }
  std::optional<RoomPlane> largest;
  const std::vector<uint8_t> none(room.model.size(), 0);
  for (RoomPlane& plane : room_planes(room, classes, none, place_inside(room, cameras))) {
    if (!largest || plane.carriers.size() > largest->carriers.size()) largest = std::move(plane);
  }
  return largest;
}

/// Rugs with a number, the largest first.
std::vector<RugKey> rugs_of(const GaussianLabels& labels, const std::vector<CarryingClass>& classes) {
  std::map<RugKey, size_t> sizes;
  for (size_t i = 0; i < labels.label.size(); ++i) {
    const uint16_t label = labels.label[i];
    if (label < classes.size() && classes[label].on_floor && labels.instance[i] > 0)
      ++sizes[{label, labels.instance[i]}];
  }
  std::vector<RugKey> rugs;
  for (const auto& entry : sizes) rugs.push_back(entry.first);
  std::stable_sort(rugs.begin(), rugs.end(),
                   [&](const RugKey& a, const RugKey& b) { return sizes.at(a) > sizes.at(b); });
  return rugs;
}

/// Gaussians of the floor and of rugs that lie on a plane.
std::vector<uint32_t> flat_rows(const LabelledGaussians& room, const std::vector<CarryingClass>& classes,
                                const PlaneOf& floor, double thick) {
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < room.labels.label.size(); ++i) {
    const uint16_t label = room.labels.label[i];
    if (label >= classes.size() || !(classes[label].on_floor || classes[label].shell == PlaneKind::kFloor)) continue;
    if (std::fabs(floor.height(position_of(room.model, i))) <= thick) rows.push_back(i);
  }
  return rows;
}

}  // namespace

size_t complete_rugs(LabelledGaussians& room, const LabelSet& labels, const std::vector<Camera>& cameras,
                     const WholeRugOptions& options) {
  const std::vector<CarryingClass> classes = carrying_classes(labels);
  GaussianLabels& of = room.labels;
  const std::vector<RugKey> rugs = rugs_of(of, classes);
  if (rugs.empty()) return 0;
  const std::optional<RoomPlane> floor = largest_floor(room, classes, cameras);
  if (!floor) return 0;
  const std::vector<uint32_t> flat = flat_rows(room, classes, *floor, options.thick * room.extent);
  if (flat.empty()) return 0;
  const FloorPicture picture = paint_floor(room.model, flat, *floor, options.cell * room.extent);

  std::vector<std::optional<size_t>> cells;
  for (const uint32_t i : flat)
    cells.push_back(picture.grid.cell_at(picture.grid.place_of(position_of(room.model, i))));
  size_t changed = 0;
  for (const RugKey& rug : rugs) {
    const auto is_of_it = [&](uint32_t i) { return of.label[i] == rug.first && of.instance[i] == rug.second; };
    CellRegion labelled(picture.grid.size(), 0);
    for (size_t k = 0; k < flat.size(); ++k) {
      if (cells[k] && is_of_it(flat[k]) && opacity_of(room.model, flat[k]) >= kSolidOpacity) labelled[*cells[k]] = 1;
    }
    const auto whole = RugGrowth(picture, without_gaps(labelled, picture), room.extent, options).whole();
    if (!whole) continue;
    for (size_t k = 0; k < flat.size(); ++k) {
      if (!cells[k] || !(*whole)[*cells[k]] || is_of_it(flat[k])) continue;
      of.label[flat[k]] = rug.first;
      of.instance[flat[k]] = rug.second;
      ++changed;
    }
  }
  return changed;
}

}  // namespace aligngs
