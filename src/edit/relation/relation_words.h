// Words for where a thing is: "on", "next to", "to the left of".
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace aligngs {

/// The place of one object relative to another one.
enum class Relation {
  kOn,         ///< rests on it, or hangs on that wall
  kIn,         ///< within its box, or on a board of it
  kUnder,      ///< below it, seen from above in the same place
  kAbove,      ///< over it in the same place, resting on it or not
  kNextTo,     ///< the gap is small
  kNear,       ///< the gap is no larger than a step
  kNearest,    ///< of all, the one with the smallest gap
  kLeftOf,     ///< beyond its left side, as the photos' cameras see it
  kRightOf,    ///< beyond its right side
  kInFrontOf,  ///< on the side of the cameras
  kBehind,     ///< on the other side
  kBetween     ///< with one of two things on each side, seen from above
};

/// A relation in a text, and its place there.
struct FoundRelation {
  Relation relation;
  size_t at, length;
};

/// The first one with words before and after it, or at the very begin where `leading`. The longer one counts where two
/// begin at one place.
std::optional<FoundRelation> find_relation(std::string_view text, bool leading = false);

/// Whether the words of a place end with "between" and one thing: the other one follows after "and".
bool wants_other_side(std::string_view text);

/// "on", "next to", ...
std::string_view relation_word(Relation relation);

}  // namespace aligngs
