// Which photos see the same things.
#pragma once

#include <vector>

#include "refine/guided_match.h"

namespace aligngs {

/// Share of `from`'s pixels with depth that fall into `to`'s image; 0 when the viewing directions differ by more than
/// `largest_turn` degrees or `from` has no depth.
double view_overlap(const MatchView& from, const MatchView& to, double largest_turn);

/// For every view of `from` the indices into `to` with the most overlap, at most `count`, none below `least`.
std::vector<std::vector<int>> overlapping_views(const std::vector<const MatchView*>& from,
                                                const std::vector<const MatchView*>& to, int count, double least,
                                                double largest_turn);

}  // namespace aligngs
