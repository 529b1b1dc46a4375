// Rugs of which the labels name a part alone.
#pragma once

#include "edit/selection.h"
#include "scene/camera.h"
#include "scene/label_set.h"

namespace aligngs {

/// Lengths are shares of the extent, which is about 3 m in a room.
struct WholeRugOptions {
  double cell = 0.007;    ///< of the picture of the floor (2 cm)
  double thick = 0.02;    ///< Gaussians of a rug and of the floor are this near to the floor's plane (6 cm)
  double apart = 0.13;    ///< floor farther than this from a rug has the colours of the floor (40 cm)
  double step = 0.07;     ///< a rug grows by this much at once (20 cm)
  double close = 0.02;    ///< gaps of twice this are closed: a pattern may have colours of the floor (12 cm)
  double beside = 0.021;  ///< half of the window in which colours beside an edge are averaged (6 cm)
  size_t seeds = 20;      ///< cells: fewer tell no colours
  int rounds = 16;        ///< two metres and more in each direction
  /// Share of a rectangle that a rug fills, of the cells that photos see. A rug that does at first is left alone.
  double whole = 0.9;
  double contrast = 0.15;  ///< sRGB (norm over 3 channels), median along the edge: a whole rug ends where colours end
  double better = 1.2;  ///< the factor by which a grown rug fills its rectangle and ends at colours better than before
};

/// Networks take parts of a rug for floor. A rug grows over floor that has its colours and not those of the floor
/// farther away. It takes the largest extent that fills a rectangle and ends at an edge, nearly as well as the best one
/// does. Without such an extent it stays as it is. Gaussians of the floor and of other rugs within it get its class and number.
///
/// `cameras` tell which side of the floor is up, as for correct_shell_labels(). Returns how many Gaussians have another
/// label or object.
size_t complete_rugs(LabelledGaussians& room, const LabelSet& labels, const std::vector<Camera>& cameras,
                     const WholeRugOptions& options = {});

}  // namespace aligngs
