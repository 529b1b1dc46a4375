// Blending weights of one tile: every later product of the tile is linear algebra on them.
#pragma once

#include <cstdint>

#include "engine/cpu/aligned_array.h"
#include "engine/cpu/binning.h"
#include "engine/cpu/blend_record.h"
#include "engine/cpu/splats.h"
#include "engine/settings.h"

namespace aligngs::cpu {

/// The Gaussians blended in one block of 8 x 8 pixels, nearest first. Only those with a weight somewhere in the
/// block have an entry; pixels they miss hold zeros.
struct BlockWeights {
  int x = 0, y = 0;              ///< image coordinates of the first pixel
  size_t count = 0;              ///< entries
  AlignedArray<uint32_t> entry;  ///< [count] index into TileWeights::splats
  AlignedArray<float> alpha;     ///< [count][64] in the entry's strips; elsewhere unspecified
  AlignedArray<float> weight;    ///< [count][64] w = alpha T
  AlignedArray<float> gain;      ///< [count][64] T * d alpha / d power with raster.smooth_cutoff only; else it is
                                 ///< the weight below alpha_max and 0 at alpha_max
  AlignedArray<uint8_t> strips;  ///< [count] bit k: some weight in pixels [16 k, 16 k + 16)
  alignas(64) float transmittance[kBlockPixels];  ///< what is left behind the last entry
  bool open = false;                              ///< some pixel is live

  AlignedArray<uint32_t> candidates;  ///< scratch: gathered splats that may touch the block
};

/// Scratch of one thread, reused from tile to tile.
struct TileWeights {
  AlignedArray<Splat> splats;    ///< [count] the tile's Gaussians in depth order, as far as any pixel is open
  AlignedArray<uint32_t> rows;   ///< [count] their rows in the model
  AlignedArray<int32_t> places;  ///< [count] scratch of recompute_tile_weights: their places in the tile's list
  size_t count = 0;
  BlockWeights blocks[kTileBlocks];
};

/// Blends tile (tile_x, tile_y) of the view into `out` (contents replaced). The same input gives the same bits
/// whenever it is called.
void compute_tile_weights(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                          const RasterSettings& raster, TileWeights& out);

/// The same bits from the record of a forward pass. Only Gaussians that some pixel took are gathered, and only the
/// strips that took them are computed.
void recompute_tile_weights(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                            const RasterSettings& raster, const BlendRecord& record, TileWeights& out);

}  // namespace aligngs::cpu
