// The projected Gaussians of one view, as binning and blending read them.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/cpu/aligned_array.h"
#include "engine/formulas/projection.h"
#include "engine/formulas/splat.h"

namespace aligngs::cpu {

using aligngs::Splat;
using aligngs::TileRect;

/// Pixels of a block's edge. A tile of 16 x 16 is blended as four blocks. W, the matrix of blending weights, is about
/// 20 % dense over a tile and 45 % over a block.
inline constexpr int kBlockSize = 8;
inline constexpr int kBlockPixels = kBlockSize * kBlockSize;  ///< pixel (x, y) of a block has index 8 y + x
inline constexpr int kStripPixels = 16;                       ///< a strip of 8 x 2 pixels: one vector of AVX-512
inline constexpr int kTileBlocks = (kTileSize / kBlockSize) * (kTileSize / kBlockSize);

/// One entry per Gaussian of the model. Entries whose rectangle is empty are culled; their other fields are stale.
struct ProjectedView {
  ProjectionCamera<float> camera;
  int width = 0, height = 0;  ///< pixels
  int tiles_x = 0, tiles_y = 0;
  AlignedArray<Splat> splats;
  std::vector<TileRect> rects;  ///< computed once, read by every later pass
  std::vector<float> radius;    ///< 3 standard deviations along the longer axis, pixels
  int64_t non_finite = -1;      ///< first row with a parameter that is NaN or infinite; -1: none
  size_t size() const { return rects.size(); }
  size_t tiles() const { return size_t(tiles_x) * tiles_y; }
};

}  // namespace aligngs::cpu
