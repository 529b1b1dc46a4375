// Words for where a thing is: "on", "next to", "to the left of".
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace aligngs {

/// The place of one object relative to another one.
enum class Relation {
  kOn,         ///< rests on it, or hangs on that wall
  kIn,         ///< within its box, or on a board of it; not on the top of a wardrobe
  kOwned,      ///< in it or on it: "the bed's pillows"
  kUnder,      ///< below it, seen from above in the same place
  kAbove,      ///< over it in the same place, resting on it or not
  kNextTo,     ///< the gap is small
  kNear,       ///< the gap is no larger than a step
  kNearest,    ///< of all, the one with the smallest gap
  kFarthest,   ///< of all, the one with the largest gap
  kLeftOf,     ///< beyond its left side, as the photos' cameras see it
  kRightOf,    ///< beyond its right side
  kInFrontOf,  ///< on the side of the cameras
  kBehind,     ///< on the other side
  kBetween,    ///< with one of two things on each side, seen from above
  kLeftSide,   ///< on its left half, or beyond its left side
  kRightSide,  ///< on its right half, or beyond its right side
  kBothSides,  ///< beyond its left or its right side
  kHolding,    ///< the other one rests on it, or is in it
  kInCorner,   ///< close to two walls of the room
  kRoomMiddle  ///< of all, the one nearest to the middle of the floor
};

/// A relation in a text, and its place there.
struct FoundRelation {
  Relation relation;
  size_t at, length;
};

/// The first one with words before and after it, or at the very begin where `leading`. The longer one counts where two
/// begin at one place.
std::optional<FoundRelation> find_relation(std::string_view text, bool leading = false);

/// Whether a relation is to the room, and has no other thing.
bool is_of_room(Relation relation);

/// Whether a gap tells which of several is meant: "next to", "left of".
bool is_distance(Relation relation);

/// Whether one of all objects is meant, in an order: "nearest to", "farthest from".
bool is_in_order(Relation relation);

/// Whether the words of a place end with "between" and one thing: the other one follows after "and".
bool wants_other_side(std::string_view text);

/// "on", "next to", ...
std::string_view relation_word(Relation relation);

}  // namespace aligngs
