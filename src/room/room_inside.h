// The inside of a room for a camera: its outline seen from above, its height, and its obstacles.
#pragma once

#include <vector>

#include "core/rigid.h"
#include "room/measured_room.h"

namespace aligngs {

class RoomInside {
 public:
  /// The outline and the ceiling of room.json.
  static RoomInside of_room(const MeasuredRoom& room);
  /// The upright box around `points` (world) with the smallest floor, without the outer 2 % on each side.
  /// Error{kBadInput} for fewer than 16 points. `up`: unit, world.
  static RoomInside of_points(const std::vector<Vec3d>& points, const Vec3d& up);

  /// Points (world) of what a camera at `height` cannot go through.
  void add_obstacles(const std::vector<Vec3d>& points, double height);

  const Similarity& to_room() const { return to_room_; }  ///< from the world: z up, the floor at z = 0
  double height() const { return height_; }               ///< of the ceiling at its lowest
  double diagonal() const { return diagonal_; }           ///< of the box around the outline
  double margin() const;                                  ///< that a camera keeps from a wall

  /// Distance from the outline, negative outside.
  double clearance(const Vec2d& p) const;
  /// The nearest place that keeps the margin, or as much of it as the room has.
  Vec2d inside(const Vec2d& p) const;
  /// How far a ray goes until the outline, and until the first obstacle; `direction`: unit.
  double wall_distance(const Vec2d& from, const Vec2d& direction) const;
  double free_distance(const Vec2d& from, const Vec2d& direction) const;

 private:
  RoomInside(Similarity to_room, std::vector<Vec2d> outline, double height);
  bool blocked(const Vec2d& p) const;

  Similarity to_room_;
  std::vector<Vec2d> outline_;  ///< counter-clockwise
  double height_ = 0, diagonal_ = 0, cell_ = 1;
  Vec2d low_, high_, anchor_;  ///< of the outline; a place far from all walls
  int columns_ = 0, rows_ = 0;
  std::vector<int> counts_;  ///< points of obstacles by cell
};

}  // namespace aligngs
