// Places of a room that a hand-held camera can be at, and walks between them.
#pragma once

#include <utility>
#include <vector>

#include "synth/room_model.h"

namespace aligngs {

/// A grid over the floor, room frame. A person takes cells with room around them; the camera may be held over low
/// furniture at arm's length from such a cell.
class WalkableFloor {
 public:
  explicit WalkableFloor(const RoomModel& room);

  /// Cells where the camera may be, as floor points (x, y) in the room frame.
  const std::vector<Vec2d>& camera_places() const { return places_; }
  /// A walk of `count` places, evenly spaced along the shortest paths between stops that spread over the room.
  std::vector<Vec2d> walk(int count, size_t first_place) const;

 private:
  int cell_of(const Vec2d& p) const;
  Vec2d centre_of(int cell) const;
  std::vector<int> shortest_path(int from, int to) const;

  int columns_ = 0, rows_ = 0;
  std::vector<uint8_t> camera_;  ///< per cell: the camera may be there
  std::vector<Vec2d> places_;
};

}  // namespace aligngs
