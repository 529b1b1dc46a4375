// Which pixels the semantic loss of one step takes: all, or some of the blocks of 8 x 8 pixels that make up a tile of
// 16 x 16. Teachers are coarser than images and neighbouring pixels ask the same of a Gaussian, so that a part of them
// says nearly what all say; over 4 / quarters visits of a view every pixel has its turn.
#pragma once

#include "core/host_device.h"

namespace aligngs {

struct SemanticSample {
  int quarters = 4;  ///< blocks of every tile that take part: 4 (all pixels), 2 (a chequerboard) or 1
  int phase = 0;     ///< >= 0; which ones, counted up from visit to visit of a view

  /// Whether pixel (x, y) of the image takes part.
  ALIGNGS_HD bool takes(int x, int y) const {
    const int right = (x >> 3) & 1, down = (y >> 3) & 1;
    const int turn = 2 * (right ^ down) + down;  // the four blocks, those across the diagonal after each other
    if (quarters >= 4) return true;
    return quarters == 2 ? turn / 2 == (phase & 1) : turn == (phase & 3);
  }

  /// What a taken pixel counts, so that sums over taken pixels are on average the sums over all.
  ALIGNGS_HD float scale() const { return 4.0f / static_cast<float>(quarters); }
};

}  // namespace aligngs
