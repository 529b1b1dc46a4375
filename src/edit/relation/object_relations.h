// Whether one object of a room is on, under, near or beside another one.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "edit/fill/carrying_classes.h"
#include "edit/relation/relation_words.h"
#include "edit/relation/room_objects.h"

namespace aligngs {

/// Lengths are metres. A room without a scale counts a third of its extent as a metre.
struct RelationLimits {
  double next_to = 0.5;  ///< gap up to which a thing is next to another
  double near = 1;       ///< and up to which it is near
  double beside = 2;     ///< gap up to which a thing is left of, right of, behind or in front of another
  double touch = 0.1;    ///< gap up to which a thing is on a wall or on the floor
  double foot = 0.25;    ///< height up to which furniture is on the floor: photos may not show its foot
  double top = 0.03;     ///< depth below a wardrobe's top from which on a thing is in it
  double around = 0.25;  ///< by which a footprint is widened for things that hang above it
  double inside = 0.05;  ///< by which a box is widened for things in it, or under it
  double share = 0.5;    ///< of the smaller footprint that lies over or under the other one
  double apart = 135;    ///< degrees from one thing to the other around what is between them
};

class ObjectRelations {
 public:
  /// `objects` outlives this.
  explicit ObjectRelations(const RoomObjects& objects, const RelationLimits& limits = {})
      : objects_(objects), limits_(limits), classes_(carrying_classes(objects.labels())) {}

  /// The gap in metres where object `a` has the relation to object `b`, else nothing. Error{kBadInput} where the
  /// relation needs a direction that the room does not tell.
  std::optional<double> gap_where(size_t a, Relation relation, size_t b) const;
  /// The sum of both gaps in metres where object `a` is between two others, seen from above. Those are in directions
  /// that are more than a right angle and a half of one apart. Walls are in each direction in which they are.
  std::optional<double> gap_between(size_t a, size_t one, size_t other) const;

  bool is_carried(size_t a) const;  ///< by furniture

 private:
  /// Unit directions on the floor from the middle of `a` to `b`: to its nearest place, or to all of a wall's near places.
  std::vector<Vec2d> directions(size_t a, size_t b) const;
  bool is_on(size_t a, size_t b) const;
  bool is_on_shell(size_t a, size_t b) const;
  bool stands(size_t a) const;       ///< on the floor
  bool is_on_a_top(size_t a) const;  ///< of other furniture, by its height
  std::optional<size_t> pot_of(size_t a) const;
  bool is_in(size_t a, size_t b) const;
  bool is_above_inside(size_t a, size_t b) const;  ///< on the top of a wardrobe, not in it
  bool is_above(size_t a, size_t b) const;
  bool is_on_side(size_t a, Relation side, size_t b) const;
  bool is_beside(size_t a, Relation relation, size_t b) const;
  const std::set<size_t>& contents(const std::vector<size_t>& carriers) const;

  const RoomObjects& objects_;
  RelationLimits limits_;
  std::vector<CarryingClass> classes_;                                ///< per class
  mutable std::map<std::vector<size_t>, std::set<size_t>> contents_;  ///< of carriers that were asked for
};

}  // namespace aligngs
