#include "room/find_room.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/error.h"
#include "core/log.h"
#include "core/quantile.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr double kStray = 0.01;  // share of the heights that are taken for strays where floor or ceiling is assumed

std::vector<double> heights_of(const std::vector<SeenRay>& rays) {
  std::vector<double> z;
  for (const SeenRay& ray : rays) z.push_back(ray.to.z);
  return z;
}

/// Planes of the ceiling in the room's frame: the level one, or those that slope.
std::vector<CeilingPlane> ceiling_of(const std::vector<ScenePlane>& planes, const RoomFrame& frame,
                                     const RoomSettings& s) {
  const double flat = std::cos(s.flat_ceiling * kRadiansPerDegree);
  size_t all = 0, most = 0;
  const ScenePlane* level = nullptr;
  for (const size_t i : frame.ceilings) {
    all += planes[i].points;
    const bool is_level = -(frame.to_room.rotation * planes[i].normal).z > flat;
    if (is_level && planes[i].points > most) most = planes[i].points, level = &planes[i];
  }
  std::vector<CeilingPlane> out;
  for (const size_t i : frame.ceilings) {
    const ScenePlane plane = in_frame(planes[i], frame.to_room);
    const bool sloping =
        -plane.normal.z <= flat && static_cast<double>(plane.points) > s.least_slope_share * static_cast<double>(all);
    if (sloping) out.push_back({plane.normal, plane.offset});
    // A level ceiling is exactly level at the height of its points.
    if (&planes[i] == level) out.push_back({{0, 0, -1}, plane.centre.z});
  }
  return out;
}

std::vector<PlanLine> plan_lines(const std::vector<ScenePlane>& planes, const RoomFrame& frame, double height) {
  std::vector<PlanLine> lines;
  for (const size_t i : frame.walls) {
    const ScenePlane plane = in_frame(planes[i], frame.to_room);
    const double level = std::hypot(plane.normal.x, plane.normal.y);
    // A wall that leans is taken at half height.
    lines.push_back({{plane.normal.x / level, plane.normal.y / level},
                     (plane.offset + plane.normal.z * height / 2) / level,
                     false});
  }
  return lines;
}

void scale_lengths(std::vector<PlanLine>& lines, double factor) {
  for (PlanLine& line : lines) line.offset *= factor;
}

/// Share of the outline's area with a surface of a kind above it.
template <class Is>
double area_seen(const std::vector<MeasuredWall>& walls, const std::vector<SeenRay>& rays, double cell, Is&& is) {
  Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
  for (const MeasuredWall& w : walls) {
    low = {std::min(low.x, w.from.x), std::min(low.y, w.from.y)};
    high = {std::max(high.x, w.from.x), std::max(high.y, w.from.y)};
  }
  const int columns = static_cast<int>((high.x - low.x) / cell) + 1,
            rows = static_cast<int>((high.y - low.y) / cell) + 1;
  std::vector<uint8_t> seen(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (const SeenRay& ray : rays) {
    if (!is(ray)) continue;
    const int x = static_cast<int>(std::floor((ray.to.x - low.x) / cell)),
              y = static_cast<int>(std::floor((ray.to.y - low.y) / cell));
    if (x >= 0 && y >= 0 && x < columns && y < rows)
      seen[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)] = 1;
  }
  size_t all = 0, shown = 0;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (!is_inside(walls, {low.x + (x + 0.5) * cell, low.y + (y + 0.5) * cell})) continue;
      ++all;
      shown += seen[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)];
    }
  }
  return all == 0 ? 0 : static_cast<double>(shown) / static_cast<double>(all);
}

/// The frame turned about z so that the longest wall runs along x, and moved so that no corner is negative. Returns the
/// motion.
Rigidd set_axes(std::vector<OutlineSide>& sides) {
  const OutlineSide* longest = &sides.front();
  const auto length = [](const OutlineSide& side) {
    return std::hypot(side.to.x - side.from.x, side.to.y - side.from.y);
  };
  for (const OutlineSide& side : sides) {
    if (!side.line.assumed && (longest->line.assumed || length(side) > length(*longest) + 1e-9)) longest = &side;
  }
  const double l = length(*longest), c = (longest->to.x - longest->from.x) / l,
               s = (longest->to.y - longest->from.y) / l;
  const auto turn = [c, s](const Vec2d& p) { return Vec2d{c * p.x + s * p.y, -s * p.x + c * p.y}; };
  Vec2d low{1e300, 1e300};
  for (OutlineSide& side : sides) {
    side.from = turn(side.from);
    side.to = turn(side.to);
    side.line.normal = turn(side.line.normal);
    low = {std::min(low.x, side.from.x), std::min(low.y, side.from.y)};
  }
  for (OutlineSide& side : sides) {
    side.from = {side.from.x - low.x, side.from.y - low.y};
    side.to = {side.to.x - low.x, side.to.y - low.y};
    side.line.offset += side.line.normal.x * low.x + side.line.normal.y * low.y;
  }
  return {{{c, s, 0, -s, c, 0, 0, 0, 1}}, {-low.x, -low.y, 0}};
}

Similarity after(const Rigidd& motion, const Similarity& first) {
  return {first.scale, motion.rotation * first.rotation, motion * first.translation};
}

bool is_labelled(const std::vector<PlaneView>& views) {
  return std::any_of(views.begin(), views.end(), [](const PlaneView& v) {
    return std::any_of(v.labels.data.begin(), v.labels.data.end(), [](uint16_t label) { return label != kNoLabel; });
  });
}

void measure_walls(MeasuredRoom& room, const std::vector<OutlineSide>& sides, const RoomInputs& inputs,
                   const std::vector<RoomClass>& classes, const RoomSettings& s) {
  for (const OutlineSide& side : sides) {
    MeasuredWall wall;
    wall.from = side.from;
    wall.to = side.to;
    wall.normal = {side.line.normal.x, side.line.normal.y, 0};
    wall.height = (room.height_at(wall.from) + room.height_at(wall.to)) / 2;
    wall.assumed = side.line.assumed || side.evidence.wall <= 0;
    room.walls.push_back(wall);
  }
  const std::vector<SeenRay> rays = seen_rays(inputs.views, room.to_room, 1, 0);
  const std::vector<WallVotes> votes = wall_votes(room.walls, rays, classes, s.votes);
  for (size_t w = 0; w < room.walls.size(); ++w) {
    MeasuredWall& wall = room.walls[w];
    wall.seen = wall.assumed ? 0 : seen_share(votes[w]);
    double on = 0, all = 0;
    for (size_t i = 0; i < votes[w].wall.size(); ++i) {
      all += votes[w].total(i);
      on += votes[w].total(i) - votes[w].beyond[i];
    }
    wall.confidence = wall.assumed || all == 0 ? 0 : on / all;
    const std::vector<MeasuredOpening> found = find_openings(votes[w], static_cast<int>(w), *inputs.labels, s.openings);
    room.openings.insert(room.openings.end(), found.begin(), found.end());
  }
  std::stable_sort(room.openings.begin(), room.openings.end(),
                   [](const MeasuredOpening& a, const MeasuredOpening& b) { return a.kind < b.kind; });
}

}  // namespace

RoomSettings::RoomSettings() { planes.square = true; }

MeasuredRoom find_room(const RoomInputs& inputs, const RoomSettings& s, ThreadPool& pool) {
  if (!is_labelled(inputs.views)) {
    throw_bad_input({}, "labels", "no photo has labels, so that walls cannot be told from furniture",
                    "train a scene that has segmentation_logits/ (aligngs priors makes them)");
  }
  const std::vector<RoomClass> classes = room_classes(*inputs.labels);
  const std::vector<ScenePlane> planes = find_planes(inputs.views, plane_classes(*inputs.labels), s.planes, pool);
  for (const ScenePlane& p : planes)
    log_debug("plane kind {} n ({:.3f} {:.3f} {:.3f}) d {:.3f} points {} views {}", static_cast<int>(p.kind),
              p.normal.x, p.normal.y, p.normal.z, p.offset, p.points, p.views);
  const std::optional<RoomFrame> frame = find_room_frame(planes, inputs.up, s.frame);
  if (!frame) {
    throw_bad_input({}, "up", "neither a floor nor a ceiling is seen, and the scene does not say which way is up",
                    "give \"up\": [x, y, z] in scene.json");
  }
  MeasuredRoom room;
  room.to_room = {1, frame->to_room.rotation, frame->to_room.translation};
  std::vector<SeenRay> rays = seen_rays(inputs.views, room.to_room, s.outline_stride, s.label_edge);
  if (rays.empty()) throw_bad_input({}, "depth", "no photo shows a surface", "train longer, or look at the renders");
  room.floor_assumed = !frame->floor;
  if (!frame->floor) {
    room.to_room.translation.z -= quantile_of(heights_of(rays), kStray);
    rays = seen_rays(inputs.views, room.to_room, s.outline_stride, s.label_edge);
    room.warnings.push_back("No floor was found. Its height is that of the lowest surfaces.");
  }
  RoomFrame level = *frame;
  level.to_room.translation = room.to_room.translation;
  room.ceiling = ceiling_of(planes, level, s);
  room.ceiling_assumed = room.ceiling.empty();
  double height = quantile_of(heights_of(rays), 1 - kStray);
  for (const CeilingPlane& plane : room.ceiling) {
    if (plane.normal.z < -0.999999) height = plane.offset;
  }
  if (room.ceiling_assumed)
    room.warnings.push_back("No ceiling was found. Its height is that of the highest surfaces.");
  if (!(height > 0)) throw_bad_input({}, "depth", "all surfaces lie at the height of the floor", "look at the renders");

  // Settings are in metres: a world without unit is taken to be a room of the usual height until the end.
  const double metre = inputs.metres_per_unit.value_or(s.usual_height / height);
  std::vector<PlanLine> lines = plan_lines(planes, level, height);
  scale_lengths(lines, metre);
  for (CeilingPlane& plane : room.ceiling) plane.offset *= metre;
  room.to_room.scale *= metre;
  room.to_room.translation *= metre;
  for (SeenRay& ray : rays) {
    ray.from *= metre;
    ray.to *= metre;
  }
  room.height = height * metre;

  if (lines.empty()) room.warnings.push_back("No wall was found. The outline is the box of what the photos show.");
  std::vector<OutlineSide> sides = find_outline(std::move(lines), rays, classes, s.outline);
  if (sides.size() < 3)
    throw_bad_input({}, "outline", "the photos show no free space between walls", "look at the renders");
  const Rigidd motion = set_axes(sides);
  room.to_room = after(motion, room.to_room);
  for (SeenRay& ray : rays) {
    ray.from = motion * ray.from;
    ray.to = motion * ray.to;
  }
  for (CeilingPlane& plane : room.ceiling) {
    plane.normal = motion.rotation * plane.normal;
    plane.offset -= dot(plane.normal, motion.translation);
  }
  if (!room.ceiling.empty()) {
    // The highest and lowest places of planes are above corners.
    double highest = 0, lowest = 1e300;
    const bool has_level = std::any_of(room.ceiling.begin(), room.ceiling.end(),
                                       [](const CeilingPlane& p) { return p.normal.z < -0.999999; });
    if (!has_level) room.height = 1e300;
    for (const OutlineSide& side : sides) {
      highest = std::max(highest, room.height_at(side.from));
      lowest = std::min(lowest, room.height_at(side.from));
    }
    room.height = has_level ? room.height : highest;
    room.lowest = lowest;
  } else {
    room.lowest = room.height;
  }
  measure_walls(room, sides, inputs, classes, s);
  const auto has = [&classes](const SeenRay& ray, bool RoomClass::*what) {
    return ray.label < classes.size() && classes[ray.label].*what;
  };
  room.floor_seen =
      area_seen(room.walls, rays, s.furniture.cell, [&](const SeenRay& ray) { return has(ray, &RoomClass::floor); });
  room.ceiling_seen =
      area_seen(room.walls, rays, s.furniture.cell, [&](const SeenRay& ray) { return has(ray, &RoomClass::ceiling); });
  const size_t assumed = static_cast<size_t>(
      std::count_if(room.walls.begin(), room.walls.end(), [](const MeasuredWall& w) { return w.assumed; }));
  if (assumed > 0)
    room.warnings.push_back(std::to_string(assumed) + " of " + std::to_string(room.walls.size()) +
                            " walls are assumed: no photo shows them.");

  std::vector<ObjectPoints> objects = inputs.objects;
  for (ObjectPoints& object : objects) {
    for (Vec3d& p : object.points) p = room.to_room * p;
  }
  room.boxes = find_boxes(join_pieces(std::move(objects)), {room.walls, std::move(rays), room.height}, s.furniture);
  // A box outside is a mirror image, or seen through a pane.
  std::erase_if(room.boxes, [&room](const MeasuredBox& box) { return !is_inside(room.walls, box.centre); });
  room.metric = inputs.metres_per_unit.has_value();
  room.scale_source = room.metric ? inputs.scale_source : ScaleSource::kUnknown;
  return room.metric ? room : rescaled(std::move(room), 1 / metre);
}

}  // namespace aligngs
