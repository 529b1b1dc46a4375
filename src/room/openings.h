// Doors, windows, pictures and mirrors as rectangles on their walls.
#pragma once

#include <vector>

#include "room/wall_votes.h"

namespace aligngs {

struct OpeningSettings {
  double agreement = 0.5;    ///< share of a square's votes for a kind from which it is of that kind
  int gap = 3;               ///< squares between two pieces that are one thing: mullions, the arms of a plant before it
  double least_side = 0.12;  ///< metres
  double least_area = 0.03;  ///< square metres
  double least_filled = 0.5;   ///< share of a rectangle's seen squares that are of the kind
  double side_share = 0.5;     ///< of the squares along a side of the rectangle that must be of the kind
  double snap_to_floor = 0.2;  ///< metres: a door this near to the floor reaches it
  /// Metres: pictures and mirrors hang on their wall. One that lies farther behind it is a window's pane in its niche.
  double niche = 0.05;
  double deepest_niche = 0.3;  ///< metres, of a thick outer wall; what a mirror reflects lies farther behind it
};

/// The rectangles on wall number `wall`, largest first by kind. A side with few squares of the kind is drawn in. The
/// nose of a window sill or a stray label hence does not widen the rectangle.
std::vector<MeasuredOpening> find_openings(const WallVotes& votes, int wall, const LabelSet& labels,
                                           const OpeningSettings& settings = {});

}  // namespace aligngs
