// Places of things: wall frames, the room's shell with its openings, and free floor.
#pragma once

#include <vector>

#include "synth/mesh_builder.h"
#include "synth/room_style.h"

namespace aligngs {

/// A hole for a window, or the place of a door, on one wall. s runs along the local x axis of wall_frame, metres
/// from the wall's first corner.
struct WallOpening {
  double s0 = 0, s1 = 0, z0 = 0, z1 = 0;
  bool is_door = false;
  bool overexposed = false;  ///< windows: much brighter than a camera can hold
};

/// One side of the room: 0 is y = 0, then counter-clockwise seen from above (x = width, y = depth, x = 0).
struct WallPlan {
  bool feature = false;  ///< wallpaper, brick or tiles instead of bare paint
  std::vector<WallOpening> openings;
};

struct RoomPlan {
  double width = 0, depth = 0, height = 0;
  WallPlan walls[4];
  double wall_length(int wall) const { return wall % 2 == 0 ? width : depth; }
};

/// Frame of a piece against a wall: origin on the floor at distance s along it. x is along the wall, y into the room, z
/// up.
Rigidd wall_frame(const RoomPlan& plan, int wall, double s, double gap = 0.0);

/// Floor, ceiling, walls, skirting, windows with daylight behind them, doors.
void build_shell(MeshBuilder& builder, const RoomStyle& style, const RoomPlan& plan);

/// True when the rectangle keeps `margin` to every footprint on the floor, and to the walls.
bool is_free(const RoomModel& room, const FurnitureFootprint& rectangle, double margin);

/// Drops small things (plants, baskets, stools, ...) where the floor is free: up to `count` of those in `pieces`, at a
/// wall or in a corner. Each piece has a size in metres and a function that builds it.
struct LoosePiece {
  double width, depth;
  void (*add)(MeshBuilder&, const RoomStyle&);
};
void scatter_along_walls(MeshBuilder& builder, const RoomStyle& style, const RoomPlan& plan,
                         const std::vector<LoosePiece>& pieces, int count);

}  // namespace aligngs
