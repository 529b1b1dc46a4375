// The description of a room from labelled photos with depth and from its objects.
#pragma once

#include "core/thread_pool.h"
#include "refine/plane_depth.h"
#include "room/furniture.h"
#include "room/openings.h"
#include "room/outline.h"
#include "room/room_frame.h"

namespace aligngs {

/// Everything in the scene's world.
struct RoomInputs {
  std::vector<PlaneView> views;           ///< depth, labels and camera of each photo
  const LabelSet* labels = nullptr;       ///< not null
  std::optional<Vec3d> up;                ///< where the scene knows it
  std::vector<ObjectPoints> objects;      ///< of furniture classes
  std::optional<double> metres_per_unit;  ///< of the world; nothing where it is not known
  ScaleSource scale_source = ScaleSource::kUnknown;
};

struct RoomSettings {
  PlaneDepthSettings planes;
  RoomFrameSettings frame;
  RoomOutlineSettings outline;
  WallVoteSettings votes;
  OpeningSettings openings;
  FurnitureSettings furniture;
  int outline_stride = 3;          ///< pixels between the rays of the outline
  int label_edge = 2;              ///< pixels from another label that the outline's rays leave out
  double flat_ceiling = 5;         ///< degrees from level within which a ceiling is level
  double least_slope_share = 0.1;  ///< of the ceiling's points that a sloping plane must have
  /// metres: of a room in a world without unit, so that settings in metres have a meaning
  double usual_height = 2.5;
  RoomSettings();
};

/// Error{kBadInput} when there are no labels, the up direction is unknown, or no surface is seen. Without walls, floor
/// or ceiling those are assumed from the bounding box of the seen surface, with an entry in `warnings`. Deterministic
/// for any number of threads.
MeasuredRoom find_room(const RoomInputs& inputs, const RoomSettings& settings, ThreadPool& pool);

}  // namespace aligngs
