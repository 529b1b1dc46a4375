// Boxes of a room whose things have changed since it was measured: some are gone, moved or new.
#pragma once

#include <vector>

#include "room/furniture.h"

namespace aligngs {

struct FollowedBoxSettings {
  double same = 0.01;  ///< metres that a thing may differ by and be as it was: rounding, and strays of its neighbours
  double same_size = 0.1;  ///< metres that its sides may differ by when it has moved
  double same_turn = 1;    ///< degrees
};

/// Whether boxes have what they are followed by. Files of earlier programs lack it.
bool can_follow(const std::vector<MeasuredBox>& boxes);

/// The boxes of `now`, which are things in the frame of the room. All lengths are metres. A thing as it was keeps its
/// box, with the parts that no photo shows. One that has moved takes its box along. Others have the box of their
/// points. Boxes with their middle outside of the walls are left out.
std::vector<MeasuredBox> followed_boxes(const MeasuredRoom& room, std::vector<ObjectPoints> now,
                                        const FollowedBoxSettings& settings = {});

}  // namespace aligngs
