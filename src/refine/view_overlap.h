// Photos that see the same things.
#pragma once

#include <optional>
#include <vector>

#include "refine/guided_match.h"

namespace aligngs {

/// Share of `from`'s pixels with depth that fall into `to`'s image. 0 when the viewing directions differ by more than
/// `largest_turn` degrees or `from` has no depth.
double view_overlap(const MatchView& from, const MatchView& to, double largest_turn);

/// For every view of `from` the indices into `to` with the most overlap, at most `count`, none below `least`.
std::vector<std::vector<int>> overlapping_views(const std::vector<const MatchView*>& from,
                                                const std::vector<const MatchView*>& to, int count, double least,
                                                double largest_turn);

struct PixelIndex {
  int x = 0, y = 0;
};

/// The pixel of a photo (camera, H x W depth, 0 = none) that shows a place of the world. Nothing if the place is behind
/// the camera or outside of the image. Nothing, too, if the depth there differs from it by more than `agreement`
/// (relative, below 1).
std::optional<PixelIndex> pixel_showing(const Vec3d& place, const Camera& camera, const ImageF& depth,
                                        double agreement);

}  // namespace aligngs
