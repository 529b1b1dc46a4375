// Floor, ceiling and walls among everything that photos measured, without labels.
#pragma once

#include <optional>
#include <vector>

#include "room/level_planes.h"
#include "room/vertical.h"
#include "room/wall_pieces.h"

namespace aligngs {

/// Planes of anything at any angle: sloping ceilings and rooms that are not square have walls as well.
MeasuredPlaneSettings planes_at_any_angle();

struct RoomStructureSettings {
  MeasuredPlaneSettings planes = planes_at_any_angle();
  VerticalSettings vertical;
  LevelPlaneSettings level;
  WallPieceSettings walls;
  int across = 160;           ///< points that vote along the longer side of a photo, where it has so many pixels
  double upright_angle = 12;  ///< degrees from upright within which a plane may be a wall
  double usual_height = 2.5;  ///< metres, of a room in a world without unit
};

/// Pixels between points, so that `across` of them lie along the longer side of the largest photo.
int stride_for(const std::vector<MeasuredView>& views, int across);

struct StructureWall {
  ScenePlane plane;
  std::vector<WallPiece> pieces;  ///< not empty
};

/// In a frame of its own: z up, metres, or what is about a metre in a world without unit.
struct RoomStructure {
  Similarity to_frame;  ///< from the world
  Vec3d up;             ///< world, unit
  std::optional<ScenePlane> floor;
  std::vector<ScenePlane> ceilings;
  std::vector<StructureWall> walls;
  double low = 0, high = 0;  ///< heights of floor and ceiling, or of the lowest and highest surfaces
};

/// Whether a point of its frame is seen through a wall.
bool is_seen_through(const RoomStructure& structure, const SeenPoint& point, const WallPieceSettings& settings);

/// `up`: roughly, world. `metres_per_unit`: of the world, where it is known. Empty lists where nothing is found. The
/// same for any number of threads.
RoomStructure find_structure(const std::vector<MeasuredView>& views, const Vec3d& up,
                             const std::optional<double>& metres_per_unit, const RoomStructureSettings& settings,
                             ThreadPool& pool);

}  // namespace aligngs
