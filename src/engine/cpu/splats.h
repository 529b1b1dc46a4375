// The projected Gaussians of one view, as binning and blending read them.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/cpu/aligned_array.h"
#include "engine/formulas/projection.h"

namespace aligngs::cpu {

/// Pixels of a block's edge. A tile of 16 x 16 is blended as four blocks: W, the matrix of blending weights, is
/// about 20 % dense over a tile and 45 % over a block.
inline constexpr int kBlockSize = 8;
inline constexpr int kBlockPixels = kBlockSize * kBlockSize;  ///< pixel (x, y) of a block has index 8 y + x
inline constexpr int kStripPixels = 16;                       ///< a strip of 8 x 2 pixels: one vector of AVX-512
inline constexpr int kTileBlocks = (kTileSize / kBlockSize) * (kTileSize / kBlockSize);

/// Everything blending needs of one Gaussian, in one place because a tile gathers it from anywhere in memory.
///
/// Instead of the conic A it holds the factor F of log2(e)/2 A = F F^T, F = [fxx 0; fxy fyy], so that
/// exp(power) = 2^-(p^2 + r^2) with p = fxx dx + fxy dy and r = fyy dy: never positive, and a needle whose terms
/// a dx^2, 2 b dx dy, c dy^2 are a million times their sum keeps its digits.
struct alignas(16) Splat {
  float x, y;  ///< mean, pixels
  float fxx, fxy, fyy;
  float opacity;
  float level;  ///< log2(opacity / alpha_min): alpha >= alpha_min where p^2 + r^2 <= level
  float color[3];
  float normal[3], distance;  ///< plane, camera frame
  float z, z_min, z_max;      ///< depth of the centre and bounds of the intersection depth
  uint32_t slot_stride;       ///< the slot of the instance in tile (x, y) is slot_origin + y slot_stride + x;
  int64_t slot_origin;        ///< both are written by build_tile_lists
};
static_assert(sizeof(Splat) == 80, "one and a quarter cache lines");

/// Half-open range of tiles.
struct TileRect {
  uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  uint32_t area() const { return uint32_t(x1 - x0) * uint32_t(y1 - y0); }
};

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
