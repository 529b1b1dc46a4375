// The objects that gaps tell from others: "next to", "nearest to", "farthest from".
#pragma once

#include <set>
#include <string>
#include <vector>

#include "edit/relation/relation_words.h"
#include "edit/relation/room_objects.h"

namespace aligngs {

/// An object, and the one that it is on or near.
struct Related {
  size_t object = 0, anchor = 0;
  double gap = 0;  ///< metres, to the nearest anchor
};

/// The object that is clearly next to a thing: the next one is more than twice as far and a step farther. Error{kBadInput}
/// where none is. `what` is in the message.
size_t clearly_nearest(const RoomObjects& objects, std::vector<Related> related, const std::string& what);

/// The first `count` objects in the order of the relation, or only the one at `rank`. Error{kBadInput} where the ones
/// before and after a border are alike.
std::vector<size_t> first_in_order(const RoomObjects& objects, std::vector<Related> related, Relation relation,
                                   size_t count, size_t rank, const std::string& what);

/// Whether `used` may be pieces of one thing: each is close to another one, perhaps over others of `anchors`.
bool hang_together(const RoomObjects& objects, const std::set<size_t>& used, const std::vector<size_t>& anchors);

/// `did you mean "lamp#1" or "lamp#2"? `, at most three; nothing for no object.
std::string did_you_mean(const RoomObjects& objects, const std::vector<size_t>& some);

}  // namespace aligngs
