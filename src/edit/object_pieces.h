// Pieces of one object that a gap separates: a swivel chair's foot and seat, a lamp's foot and shade.
#pragma once

#include <cstddef>
#include <optional>

#include "edit/selection.h"
#include "scene/label_set.h"

namespace aligngs {

/// Lengths are shares of the extent, which is about 3 m in a room.
struct ObjectPieceSettings {
  double gap = 0.09;       ///< between a piece and its object (27 cm): the pole of a chair has other labels, or none
  double nearest = 0.05;   ///< share of the piece's Gaussians that may be nearer than the gap: strays
  double most = 0.6;       ///< Gaussians of a piece relative to its object: a second one of equal size is no piece
  double column = 0.8;     ///< share of the piece that lies above, below or within its object
  double outside = 0.017;  ///< the object's outline seen from above is widened by this (5 cm)
  double touch = 0.02;     ///< kinds of lamps or chairs this near to each other are one thing (6 cm)
  double thick = 0.06;     ///< where half of the smaller one is this near to the larger one, too (18 cm)
  double bridge = 0.02;    ///< a blanket or pillow that is this near to two pieces of a bed joins them (6 cm)
  double strays = 0.02;    ///< share of the object's Gaussians on either side that its outline leaves out
};

/// An object that is smaller than another one of its class, and is right above, below or within it, becomes a part of
/// it. Only lamps and some furniture have such pieces: books, pictures and cabinets of equal class lie above each other,
/// too. Kinds of lamps count as one class, and so do kinds of chairs. Two kinds that touch are two names for one thing.
/// Pieces of a bed or a sofa also join where a blanket, pillow or cushion lies on both: it hides what is between them.
/// Numbers of other objects do not change. Without an up direction nothing happens. Returns how many objects have joined.
size_t join_object_pieces(LabelledGaussians& room, const LabelSet& labels, const std::optional<Vec3d>& up,
                          const ObjectPieceSettings& settings = {});

}  // namespace aligngs
