// The pixels that the semantic loss of one step takes: all, or those of some squares of the image. Over 4 / quarters
// visits of a view every pixel has its turn. The squares are large, a fifth of the image, because the cost beside the
// products grows with the reached Gaussians (row gradients, Adam, softmax). Many pixels of few Gaussians are cheaper
// than few pixels of all, and each update uses more pixels.
#pragma once

#include "core/host_device.h"

namespace aligngs {

struct SemanticSample {
  static constexpr int kTileShift = 4;  ///< log2 of the edge of a tile (16 pixels), of which squares are made

  int quarters = 4;      ///< of every four neighbouring squares take part: 4 (all pixels), 2 (a chequerboard) or 1
  int phase = 0;         ///< >= 0; which ones, counted up from visit to visit of a view
  int square_shift = 6;  ///< log2 of the edge of a square in pixels, at least kTileShift

  /// Whether pixel (x, y) of the image takes part.
  ALIGNGS_HD bool takes(int x, int y) const {
    const int right = (x >> square_shift) & 1, down = (y >> square_shift) & 1;
    const int turn = 2 * (right ^ down) + down;  // the four squares, those across the diagonal after each other
    if (quarters >= 4) return true;
    return quarters == 2 ? turn / 2 == (phase & 1) : turn == (phase & 3);
  }

  /// The weight of a taken pixel, so that sums over taken pixels are on average the sums over all.
  ALIGNGS_HD float scale() const { return 4.0f / static_cast<float>(quarters); }
};

/// The sample of visit number `visit` (from 0) of a view that takes `share` (1, 0.5 or 0.25) of its pixels. The squares
/// are the largest of 16, 32, 64... pixels of which `side` holds at least three and a half. `side` is the image's
/// larger side in pixels.
inline SemanticSample make_semantic_sample(double share, int visit, int side) {
  SemanticSample sample;
  sample.quarters = share > 0.75 ? 4 : share > 0.375 ? 2 : 1;
  sample.phase = visit;
  sample.square_shift = SemanticSample::kTileShift;
  while (7 << sample.square_shift <= side) ++sample.square_shift;
  return sample;
}

}  // namespace aligngs
