// A record of the forward pass, so that the backward pass recomputes only the Gaussians that counted.
#pragma once

#include <cstdint>

#include "engine/cpu/aligned_array.h"
#include "engine/cpu/splats.h"

namespace aligngs::cpu {

inline constexpr int kBlockStrips = kBlockPixels / kStripPixels;
inline constexpr int kTileStrips = kTileBlocks * kBlockStrips;  ///< strip s of block b is number 4 b + s of the tile
inline constexpr int kTilePixels = kTileBlocks * kBlockPixels;  ///< pixel i of block b is number 64 b + i of the tile

/// A pixel takes every Gaussian with alpha >= alpha_min until one would close it. The last one taken hence determines
/// all of them, and no transmittance is tested again. 2 bytes per (Gaussian, tile) pair and 4 per pixel; keeping the
/// weights themselves would take a hundred times as much.
struct BlendRecord {
  /// [instances, in the order of TileLists::gaussians] bit k: some pixel of strip k took it.
  AlignedArray<uint16_t> strips;
  /// [tiles][256] place in the tile's list, plus one, of the last Gaussian that the pixel took; 0: none.
  AlignedArray<int32_t> last;
  /// [instances, by slot] 1: some pixel of the tile took it.
  AlignedArray<uint8_t> seen;
};
static_assert(kTileStrips <= 16, "one bit each");

}  // namespace aligngs::cpu
