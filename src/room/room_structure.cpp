#include "room/room_structure.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/log.h"
#include "room/room_frame.h"

namespace aligngs {
namespace {

ScenePlane scaled(ScenePlane plane, double factor) {
  plane.offset *= factor;
  plane.centre *= factor;
  return plane;
}

void scale_points(std::vector<SeenPoint>& points, double factor) {
  for (SeenPoint& point : points) {
    point.from *= factor;
    point.to *= factor;
    point.depth *= factor;
  }
}

void log_plane(const char* what, const ScenePlane& p) {
  log_debug("{} n ({:.3f} {:.3f} {:.3f}) d {:.3f} height {:.3f} points {} views {}", what, p.normal.x, p.normal.y,
            p.normal.z, p.offset, p.centre.z, p.points, p.views);
}

std::vector<StructureWall> walls_of(const std::vector<ScenePlane>& planes, const std::vector<SeenPoint>& points,
                                    const RoomStructure& room, const RoomStructureSettings& s) {
  const double upright = std::sin(s.upright_angle * kRadiansPerDegree);
  std::vector<StructureWall> walls;
  for (const ScenePlane& plane : planes) {
    if (!(std::abs(plane.normal.z) <= upright)) continue;
    StructureWall wall{plane, wall_pieces(plane, points, room.low, room.high, s.walls)};
    if (!wall.pieces.empty()) walls.push_back(std::move(wall));
  }
  return walls;
}

}  // namespace

bool is_seen_through(const RoomStructure& structure, const SeenPoint& point, const WallPieceSettings& settings) {
  return std::any_of(structure.walls.begin(), structure.walls.end(), [&](const StructureWall& wall) {
    return is_seen_through(wall.pieces, wall.plane, point, structure.low, structure.high, settings);
  });
}

int stride_for(const std::vector<MeasuredView>& views, int across) {
  int longest = 0;
  for (const MeasuredView& view : views) longest = std::max({longest, view.depth.width, view.depth.height});
  return std::max(1, longest / std::max(1, across));
}

MeasuredPlaneSettings planes_at_any_angle() {
  MeasuredPlaneSettings settings;
  settings.axes.least_share = 2;  // of 1: no room is taken for a square one
  settings.most = 40;
  return settings;
}

RoomStructure find_structure(const std::vector<MeasuredView>& views, const Vec3d& up,
                             const std::optional<double>& metres_per_unit, const RoomStructureSettings& s,
                             ThreadPool& pool) {
  const int stride = stride_for(views, s.across);
  MeasuredPlaneSettings settings = s.planes;
  settings.stride = stride;
  std::vector<ScenePlane> planes = measured_planes(views, settings, pool);
  RoomStructure out;
  out.up = vertical_near(normalized(up), planes, s.vertical);
  out.to_frame = {1, upright_rotation(out.up), {}};
  for (ScenePlane& plane : planes) plane = in_frame(plane, {out.to_frame.rotation, {}});
  std::vector<SeenPoint> points = seen_points(views, out.to_frame, stride, pool);
  const LevelPlanes level = find_level_planes(planes, points, s.level);
  if (!(level.high > level.low)) return out;

  const double metre = metres_per_unit.value_or(s.usual_height / (level.high - level.low));
  out.to_frame.scale = metre;
  scale_points(points, metre);
  for (ScenePlane& plane : planes) plane = scaled(plane, metre);
  out.low = level.low * metre;
  out.high = level.high * metre;
  if (level.floor) out.floor = planes[*level.floor];
  for (const size_t i : level.ceilings) out.ceilings.push_back(planes[i]);
  if (out.floor) log_plane("floor", *out.floor);
  for (const ScenePlane& ceiling : out.ceilings) log_plane("ceiling", ceiling);
  out.walls = walls_of(planes, points, out, s);
  // Glass and its neighbourhood have ghosts of surfaces behind the wall, which are no walls.
  std::erase_if(points, [&](const SeenPoint& point) { return is_seen_through(out, point, s.walls); });
  out.walls = walls_of(planes, points, out, s);
  for (const StructureWall& wall : out.walls) {
    log_plane("wall", wall.plane);
    for (const WallPiece& piece : wall.pieces) log_debug("  from {:.2f} to {:.2f}", piece.first, piece.last);
  }
  return out;
}

}  // namespace aligngs
