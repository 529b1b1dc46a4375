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
  return is_seen_through(structure, point, s) ? StructureLabel::kBeyond : surface_of(point, structure, s);
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
