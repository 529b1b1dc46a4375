#include "room/structure_labels.h"

#include <cmath>

#include "core/is_depth.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

bool is_within(const StructureWall& wall, const Vec3d& p, double margin) {
  const double along = along_plane(wall.plane, p);
  for (const WallPiece& piece : wall.pieces) {
    if (along > piece.first - margin && along < piece.last + margin) return true;
  }
  return false;
}

/// How far behind a wall a point is that is seen through it; 0 where it is not.
double behind_wall(const StructureWall& wall, const SeenPoint& point, const RoomStructure& structure,
                   const WallPieceSettings& s) {
  const double before = wall.plane.distance(point.from), behind = -wall.plane.distance(point.to);
  if (before <= 0 || behind < s.beyond) return 0;
  const Vec3d p = point.from + (point.to - point.from) * (before / (before + behind));
  return p.z > structure.low && p.z < structure.high && is_within(wall, p, 0) ? behind : 0;
}

/// The surface that a point is on: the one whose plane is nearest.
StructureLabel surface_of(const SeenPoint& point, const RoomStructure& structure, const WallPieceSettings& s) {
  StructureLabel label = StructureLabel::kOther;
  double nearest = 1e300;
  const auto offer = [&](const ScenePlane& plane, StructureLabel as) {
    const double distance = std::abs(plane.distance(point.to));
    if (distance < nearest && is_on(point, plane, s)) nearest = distance, label = as;
  };
  if (structure.floor) offer(*structure.floor, StructureLabel::kFloor);
  for (const ScenePlane& ceiling : structure.ceilings) offer(ceiling, StructureLabel::kCeiling);
  for (const StructureWall& wall : structure.walls) {
    if (is_within(wall, point.to, s.cell)) offer(wall.plane, StructureLabel::kWall);
  }
  return label;
}

StructureLabel label_of(const SeenPoint& point, const RoomStructure& structure, const WallPieceSettings& s) {
  double behind = 0;
  for (const StructureWall& wall : structure.walls)
    behind = std::max(behind, behind_wall(wall, point, structure, s));
  if (behind >= s.room_beyond) return StructureLabel::kBeyond;
  const StructureLabel label = surface_of(point, structure, s);
  return behind > 0 && label == StructureLabel::kOther ? StructureLabel::kBeyond : label;
}

}  // namespace

const LabelSet& structure_label_set() {
  static const LabelSet set = [] {
    LabelSet out;
    out.name = "structure";
    for (const char* name : {"wall", "floor", "ceiling", "other", "beyond a wall"})
      out.classes.push_back({name, {}, {}});
    return out;
  }();
  return set;
}

Image<uint16_t> structure_labels(const MeasuredView& view, const RoomStructure& structure,
                                 const RoomStructureSettings& settings) {
  const int width = view.depth.width, height = view.depth.height;
  Image<uint16_t> out(width, height, 1, kNoLabel);
  if (view.depth.empty()) return out;
  const ImageF normals = surface_normals(view);
  const Mat3d turn = structure.to_frame.rotation * transpose(view.camera.world_to_camera.rotation);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!is_depth(view.depth.at(x, y))) continue;
      SeenPoint point = seen_point(view, x, y, structure.to_frame);
      point.normal = turn * Vec3d{normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)};
      out.at(x, y) = static_cast<uint16_t>(label_of(point, structure, settings.walls));
    }
  }
  return out;
}

}  // namespace aligngs
