// Colour, alpha, normal, distance and depths of a tile.
#pragma once

#include "engine/cpu/aligned_array.h"
#include "engine/cpu/binning.h"
#include "engine/cpu/blend_record.h"
#include "engine/cpu/splats.h"
#include "engine/settings.h"

namespace aligngs::cpu {

/// The maps of engine/maps.h for the 64 pixels of a block. Without geometry only colour and alpha mean anything.
struct BlockMaps {
  alignas(64) float color[3][kBlockPixels];
  alignas(64) float alpha[kBlockPixels];
  alignas(64) float normal[3][kBlockPixels];
  alignas(64) float distance[kBlockPixels];
  alignas(64) float expected[kBlockPixels];
  alignas(64) float median[kBlockPixels];
  alignas(64) float transmittance[kBlockPixels];  ///< what is left behind the last Gaussian
  alignas(64) int32_t last[kBlockPixels];         ///< as in BlendRecord
};

/// Maps that a pass over the tiles blends. With kMedian a pixel ends where its median depth is known: nothing else is
/// valid then, `seen` and the strips neither.
enum class BlendedMaps : uint8_t {
  kColor,
  kLosses,  ///< all but the median depth, which no loss reads
  kAll,
  kMedian
};
/// Whether normals, distance and expected depth are among them.
constexpr bool has_geometry(BlendedMaps maps) { return maps == BlendedMaps::kLosses || maps == BlendedMaps::kAll; }
constexpr bool has_median(BlendedMaps maps) { return maps == BlendedMaps::kAll || maps == BlendedMaps::kMedian; }

/// Scratch of one thread.
struct TileForward {
  AlignedArray<Splat> splats;     ///< the next Gaussians of the tile
  AlignedArray<uint32_t> lists;   ///< [strips of the tile][kGather] which of them each strip may see
  AlignedArray<uint16_t> strips;  ///< [length of the tile's list] out: as in BlendRecord
  BlockMaps blocks[kTileBlocks];  ///< out, in the order of TileWeights::blocks
};

/// Blends tile (tile_x, tile_y) of the view into out.blocks. Takes the same alphas, bit for bit, as
/// compute_tile_weights, but keeps none of them. Each strip of 8 x 2 pixels sums its maps in registers over the
/// Gaussians that can reach it. A strip ends when its own pixels are closed. `seen` [slots], unless nullptr, receives a
/// 1 for every Gaussian that some pixel took.
void blend_tile_forward(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                        const RasterSettings& raster, BlendedMaps maps, uint8_t* seen, TileForward& out);

}  // namespace aligngs::cpu
