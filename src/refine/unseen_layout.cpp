#include "refine/unseen_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "refine/push_pull.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

// A plane of more squares than this is no wall of a room: its extent or the size of the squares is wrong.
constexpr double kMostCells = 4e6;

/// Evidence of the photos about a square.
enum class Seen : uint8_t { kNothing, kSurface, kThrough };

bool usable(float z) { return z > 0 && std::isfinite(z); }

/// Surfaces in the world, and how far from their camera.
struct Surfaces {
  std::vector<Vec3d> points;
  std::vector<double> depths;
};

Surfaces surfaces_of(const std::vector<LayoutView>& views, int stride) {
  Surfaces out;
  for (const LayoutView& view : views) {
    const Rigidd to_world = view.plane.camera.world_to_camera.inverse();
    for (int y = stride / 2; y < view.plane.depth.height; y += stride) {
      for (int x = stride / 2; x < view.plane.depth.width; x += stride) {
        const float z = view.plane.depth.at(x, y);
        if (!usable(z)) continue;
        out.points.push_back(to_world * (view.plane.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(z)));
        out.depths.push_back(z);
      }
    }
  }
  return out;
}

bool bounds_room(const ScenePlane& plane, const Surfaces& surfaces, const std::vector<LayoutView>& views,
                 const LayoutSettings& s) {
  for (const LayoutView& view : views) {
    if (plane.distance(view.plane.camera.centre()) <= 0) return false;
  }
  size_t behind = 0;
  for (size_t i = 0; i < surfaces.points.size(); ++i)
    behind += plane.distance(surfaces.points[i]) < -2 * s.agreement * surfaces.depths[i];
  return static_cast<double>(behind) <= s.behind * static_cast<double>(surfaces.points.size());
}

/// A plane divided into squares: square (i, j) has its centre at origin + (i + 1/2) cell * right + (j + 1/2) cell * up.
struct Grid {
  Vec3d origin, right, up;
  int columns = 0, rows = 0;
  Vec3d centre(int i, int j, double cell) const {
    return origin + right * ((i + 0.5) * cell) + up * ((j + 0.5) * cell);
  }
};

/// The lowest and highest of the values but for a share at each end; cameras count in full, they are in the room.
struct Range {
  double low, high;
};
Range range_of(const Surfaces& surfaces, const std::vector<LayoutView>& views, const Vec3d& axis, double quantile) {
  std::vector<double> along;
  along.reserve(surfaces.points.size());
  for (const Vec3d& p : surfaces.points) along.push_back(dot(axis, p));
  std::sort(along.begin(), along.end());
  const size_t cut = static_cast<size_t>(quantile * static_cast<double>(along.size()));
  Range range{along[cut], along[along.size() - 1 - cut]};
  for (const LayoutView& view : views) {
    const double at = dot(axis, view.plane.camera.centre());
    range.low = std::min(range.low, at);
    range.high = std::max(range.high, at);
  }
  return range;
}

Grid grid_on(const ScenePlane& plane, const Surfaces& surfaces, const std::vector<LayoutView>& views,
             const LayoutSettings& s) {
  Grid grid;
  const Vec3d other = std::abs(plane.normal.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  grid.right = normalized(cross(other, plane.normal));
  grid.up = cross(plane.normal, grid.right);
  const Range u = range_of(surfaces, views, grid.right, s.box_quantile),
              v = range_of(surfaces, views, grid.up, s.box_quantile);
  grid.origin = plane.normal * -plane.offset + grid.right * u.low + grid.up * v.low;
  const double columns = std::ceil((u.high - u.low) / s.cell), rows = std::ceil((v.high - v.low) / s.cell);
  if (!(columns * rows <= kMostCells)) return grid;  // no squares
  grid.columns = static_cast<int>(columns);
  grid.rows = static_cast<int>(rows);
  return grid;
}

/// Evidence of all photos about a square, and its look where they show it.
struct Square {
  Seen seen = Seen::kNothing;
  Vec3f color;                ///< mean over the photos that show the plane's own kind there
  uint16_t label = kNoLabel;  ///< of the last of them
};

Square look_at(const Vec3d& x, const ScenePlane& plane, const std::vector<LayoutView>& views,
               const std::vector<PlaneClass>& classes, const LayoutSettings& s) {
  int surface = 0, through = 0, own = 0;
  Square square;
  for (const LayoutView& view : views) {
    const Camera& camera = view.plane.camera;
    const Vec3d p = camera.world_to_camera * x;
    if (!(p.z > 0)) continue;
    const Vec2d pixel = camera.project(p);
    if (!camera.contains(pixel)) continue;
    const int i = static_cast<int>(pixel.x), j = static_cast<int>(pixel.y);
    const float z = view.plane.depth.at(i, j);
    if (!usable(z)) continue;
    const Vec3d seen = camera.unproject(pixel.x, pixel.y, z);
    if (std::abs(z - p.z) <= s.agreement * p.z || std::abs(plane.distance(seen)) <= 0.5 * s.agreement * z) {
      ++surface;
      const uint16_t label = view.plane.labels.empty() ? kNoLabel : view.plane.labels.at(i, j);
      if (label >= classes.size() || classes[label].kind != plane.kind || classes[label].glass) continue;
      const float* rgb = view.color.pixel(i, j);
      square.color += Vec3f{rgb[0], rgb[1], rgb[2]};
      square.label = label;
      ++own;
    } else if (z > p.z * (1 + s.beyond)) {
      ++through;
    } else if (z > p.z) {
      ++surface;  // a little behind, as a pane in its niche: nothing hides the square, so the photo shows it
    }
  }
  if (own > 0) square.color *= 1.0f / static_cast<float>(own);
  square.seen = through > surface ? Seen::kThrough : surface > 0 ? Seen::kSurface : Seen::kNothing;
  return square;
}

uint16_t commonest_label(const std::vector<Square>& squares, size_t classes) {
  std::vector<size_t> counts(classes, 0);
  for (const Square& square : squares) {
    if (square.label < classes) ++counts[square.label];
  }
  const auto most = std::max_element(counts.begin(), counts.end());
  return most == counts.end() || *most == 0 ? kNoLabel : static_cast<uint16_t>(most - counts.begin());
}

bool near_opening(const std::vector<Square>& squares, const Grid& grid, int i, int j, int reach) {
  for (int y = std::max(0, j - reach); y <= std::min(grid.rows - 1, j + reach); ++y) {
    for (int x = std::max(0, i - reach); x <= std::min(grid.columns - 1, i + reach); ++x) {
      if (squares[static_cast<size_t>(y) * static_cast<size_t>(grid.columns) + static_cast<size_t>(x)].seen ==
          Seen::kThrough)
        return true;
    }
  }
  return false;
}

/// Colours of the squares of a class, spread over all others: an unseen wall does not take after its door.
ImageF colors_of(const std::vector<Square>& squares, uint16_t label, const Grid& grid) {
  ImageF color(grid.columns, grid.rows, 3), weight(grid.columns, grid.rows, 1);
  for (size_t k = 0; k < squares.size(); ++k) {
    if (squares[k].seen != Seen::kSurface || squares[k].label != label) continue;
    weight.data[k] = 1;
    for (size_t c = 0; c < 3; ++c) color.data[3 * k + c] = squares[k].color[static_cast<int>(c)];
  }
  return push_pull(color, weight);
}

void add_unseen_part(size_t index, const std::vector<ScenePlane>& bounds, const Surfaces& surfaces,
                     const std::vector<LayoutView>& views, const std::vector<PlaneClass>& classes,
                     const LayoutSettings& s, ThreadPool& pool, UnseenLayout& out) {
  const ScenePlane& plane = bounds[index];
  const Grid grid = grid_on(plane, surfaces, views, s);
  const size_t columns = static_cast<size_t>(grid.columns);
  std::vector<Square> squares(columns * static_cast<size_t>(grid.rows));
  pool.parallel_for(static_cast<size_t>(grid.rows), 1, [&](size_t begin, size_t end, int) {
    for (size_t k = begin * columns; k < end * columns; ++k) {
      squares[k] = look_at(grid.centre(static_cast<int>(k % columns), static_cast<int>(k / columns), s.cell), plane,
                           views, classes, s);
    }
  });
  const auto seen =
      std::count_if(squares.begin(), squares.end(), [](const Square& q) { return q.seen == Seen::kSurface; });
  const uint16_t label = commonest_label(squares, classes.size());
  if (static_cast<size_t>(seen) < s.least_seen || label == kNoLabel) return;
  const ImageF colors = colors_of(squares, label, grid);
  for (size_t k = 0; k < squares.size(); ++k) {
    const int i = static_cast<int>(k % columns), j = static_cast<int>(k / columns);
    const Vec3d x = grid.centre(i, j, s.cell);
    const auto is_behind = [&](const ScenePlane& other) { return &other != &plane && other.distance(x) < 0; };
    if (squares[k].seen != Seen::kNothing || std::any_of(bounds.begin(), bounds.end(), is_behind)) continue;
    if (near_opening(squares, grid, i, j, s.clear_cells)) continue;
    const float* rgb = colors.pixel(i, j);
    out.cloud.positions.push_back(x.cast<float>());
    out.cloud.colors.push_back({rgb[0], rgb[1], rgb[2]});
    out.cloud.normals.push_back(plane.normal.cast<float>());
    out.labels.push_back(label);
  }
}

void check(const std::vector<LayoutView>& views, const LayoutSettings& settings) {
  if (!(settings.cell > 0)) throw Error({ErrorKind::kFailed, "must be positive", {}, "cell", {}});
  for (const LayoutView& view : views) {
    const Camera& c = view.plane.camera;
    if (view.color.width != c.width || view.color.height != c.height || view.color.channels != 3 ||
        view.plane.depth.width != c.width || view.plane.depth.height != c.height) {
      throw Error({ErrorKind::kFailed, "a map must have the size of its camera", {}, "color, depth", {}});
    }
  }
}

}  // namespace

UnseenLayout unseen_layout(const std::vector<LayoutView>& views, const std::vector<PlaneClass>& classes,
                           const LayoutSettings& settings, ThreadPool& pool) {
  check(views, settings);
  UnseenLayout out;
  std::vector<PlaneView> plane_views;
  for (const LayoutView& view : views) plane_views.push_back(view.plane);
  const std::vector<ScenePlane> planes = find_planes(plane_views, classes, settings.planes, pool);
  const Surfaces surfaces = surfaces_of(views, settings.planes.stride);
  if (planes.empty() || surfaces.points.empty()) return out;
  std::vector<ScenePlane> bounds;
  for (const ScenePlane& plane : planes) {
    if (bounds_room(plane, surfaces, views, settings)) bounds.push_back(plane);
  }
  for (size_t i = 0; i < bounds.size(); ++i) add_unseen_part(i, bounds, surfaces, views, classes, settings, pool, out);
  return out;
}

}  // namespace aligngs
