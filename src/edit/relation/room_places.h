// Places of the room itself: its corners and its middle.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "edit/fill/room_planes.h"
#include "edit/relation/room_objects.h"

namespace aligngs {

class RoomPlaces {
 public:
  /// `objects` outlives this.
  explicit RoomPlaces(const RoomObjects& objects) : objects_(objects) {}

  /// Metres from an object to a corner of two walls, where it is in one: at most 0.8 m from each. Error{kBadInput} where
  /// the room shows no two walls.
  std::optional<double> gap_to_corner(size_t object) const;
  /// Metres between the middle of an object and the middle of the floor, level.
  double gap_to_middle(size_t object) const;

 private:
  const std::vector<RoomPlane>& walls() const;

  const RoomObjects& objects_;
  mutable std::unique_ptr<std::vector<RoomPlane>> walls_;
};

}  // namespace aligngs
