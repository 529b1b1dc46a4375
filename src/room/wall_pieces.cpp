#include "room/wall_pieces.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

constexpr double kMostColumns = 10000;  // of a plane a kilometre long: more is an error of its points
constexpr double kLeastFront = 0.2;     // metres that a camera is before a plane on which it votes

/// Points per square of an upright plane, and what is seen through it.
struct WallGrid {
  double begin = 0;
  int columns = 0, rows = 0;
  std::vector<int> on, near, far;  ///< row-major
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
};

WallGrid grid_of(const ScenePlane& plane, const std::vector<SeenPoint>& points, double low, double high,
                 const WallPieceSettings& s) {
  WallGrid grid;
  double first = 1e300, last = -1e300;
  const auto inside = [&](double z) { return z > low + s.margin && z < high - s.margin; };
  for (const SeenPoint& point : points) {
    if (!inside(point.to.z) || !is_on(point, plane, s)) continue;
    first = std::min(first, along_plane(plane, point.to));
    last = std::max(last, along_plane(plane, point.to));
  }
  const double columns = std::floor((last - first) / s.cell) + 1,
               rows = std::ceil((high - low - 2 * s.margin) / s.cell);
  if (!(columns >= 1 && columns < kMostColumns && rows >= 1 && rows < kMostColumns)) return grid;
  grid.begin = first;
  grid.columns = static_cast<int>(columns);
  grid.rows = static_cast<int>(rows);
  const size_t squares = static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows);
  for (std::vector<int>* votes : {&grid.on, &grid.near, &grid.far}) votes->assign(squares, 0);
  for (const SeenPoint& point : points) {
    const double before = plane.distance(point.from), behind = -plane.distance(point.to);
    if (before < kLeastFront) continue;
    const bool on = is_on(point, plane, s);
    if (!on && behind < s.beyond) continue;
    const Vec3d p = on ? point.to : point.from + (point.to - point.from) * (before / (before + behind));
    const double column = std::floor((along_plane(plane, p) - first) / s.cell),
                 row = std::floor((p.z - low - s.margin) / s.cell);
    if (!(column >= 0 && column < columns && row >= 0 && row < rows)) continue;
    const size_t i = grid.index(static_cast<int>(column), static_cast<int>(row));
    ++(on ? grid.on : behind < s.room_beyond ? grid.near : grid.far)[i];
  }
  return grid;
}

struct WallColumn {
  int squares = 0;           ///< on the plane
  int bottom = 0, top = -1;  ///< the lowest and the highest of them
  bool past = false;         ///< photos look past it
};

WallColumn column_of(const WallGrid& grid, int column, const WallPieceSettings& s) {
  WallColumn out;
  for (int row = 0; row < grid.rows; ++row) {
    const size_t i = grid.index(column, row);
    if (grid.on[i] < s.least_votes || grid.on[i] < grid.near[i] + grid.far[i]) continue;
    if (out.squares++ == 0) out.bottom = row;
    out.top = row;
  }
  int over = 0, under = 0;
  for (int row = 0; row < grid.rows && out.squares > 0; ++row) {
    const size_t i = grid.index(column, row);
    const int beyond = grid.near[i] + grid.far[i];
    if (beyond < s.least_votes || beyond <= grid.on[i]) continue;
    over += row > out.top;
    under += row < out.bottom && grid.near[i] > grid.far[i];
  }
  out.past = over >= s.least_squares || under >= s.least_squares;
  return out;
}

bool is_wall(const std::vector<WallColumn>& columns, int first, int last, double height, const WallPieceSettings& s) {
  int squares = 0, seen = 0, past = 0, top = 0;
  for (int c = first; c <= last; ++c) {
    const WallColumn& column = columns[static_cast<size_t>(c)];
    squares += column.squares;
    seen += column.squares > 0;
    past += column.past;
    top = std::max(top, column.top);
  }
  return (last - first + 1) * s.cell >= s.least_length && squares * s.cell * s.cell >= s.least_area &&
         s.margin + (top + 1) * s.cell >= s.least_top * height && past < s.most_past * seen;
}

}  // namespace

double along_plane(const ScenePlane& plane, const Vec3d& p) {
  const double level = std::hypot(plane.normal.x, plane.normal.y);
  return level > 0 ? (-plane.normal.y * p.x + plane.normal.x * p.y) / level : 0;
}

bool is_on(const SeenPoint& point, const ScenePlane& plane, const WallPieceSettings& s) {
  return std::abs(plane.distance(point.to)) < std::max(s.on, s.on_of_depth * point.depth) &&
         dot(plane.normal, point.normal) > std::cos(s.normal_angle * kRadiansPerDegree);
}

bool is_seen_through(const std::vector<WallPiece>& pieces, const ScenePlane& plane, const SeenPoint& point, double low,
                     double high, const WallPieceSettings& s) {
  const double before = plane.distance(point.from), behind = -plane.distance(point.to);
  if (before <= 0 || !(behind >= s.beyond)) return false;
  const Vec3d p = point.from + (point.to - point.from) * (before / (before + behind));
  if (p.z <= low || p.z >= high) return false;
  const double along = along_plane(plane, p);
  for (const WallPiece& piece : pieces) {
    if (along < piece.first || along >= piece.last || piece.columns.empty()) continue;
    const size_t column = static_cast<size_t>((along - piece.first) / s.cell);
    const WallSpan& span = piece.columns[std::min(column, piece.columns.size() - 1)];
    if (behind >= s.room_beyond || (p.z > span.low && p.z < span.high)) return true;
  }
  return false;
}

std::vector<WallPiece> wall_pieces(const ScenePlane& plane, const std::vector<SeenPoint>& points, double low,
                                   double high, const WallPieceSettings& s) {
  const WallGrid grid = grid_of(plane, points, low, high, s);
  std::vector<WallColumn> columns;
  for (int c = 0; c < grid.columns; ++c) columns.push_back(column_of(grid, c, s));
  std::vector<WallPiece> out;
  for (int first = 0; first < grid.columns; ++first) {
    if (columns[static_cast<size_t>(first)].squares == 0) continue;
    int last = first;
    for (int c = first; c < grid.columns && (c - last) * s.cell <= s.bridged; ++c) {
      if (columns[static_cast<size_t>(c)].squares > 0) last = c;
    }
    if (is_wall(columns, first, last, high - low, s)) {
      WallPiece piece{grid.begin + first * s.cell, grid.begin + (last + 1) * s.cell, {}};
      for (int c = first; c <= last; ++c) {
        const WallColumn& column = columns[static_cast<size_t>(c)];
        const double floor = low + s.margin;
        piece.columns.push_back({floor + column.bottom * s.cell, floor + (column.top + 1) * s.cell});
      }
      out.push_back(std::move(piece));
    }
    first = last;
  }
  return out;
}

}  // namespace aligngs
