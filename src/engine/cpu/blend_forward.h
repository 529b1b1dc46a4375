// Colour, alpha, normal, distance and depths of one block from its blending weights.
#pragma once

#include "engine/cpu/tile_weights.h"
#include "engine/formulas/projection.h"

namespace aligngs::cpu {

/// The maps of engine/maps.h for the 64 pixels of a block.
struct BlockMaps {
  alignas(64) float color[3][kBlockPixels];
  alignas(64) float alpha[kBlockPixels];
  alignas(64) float normal[3][kBlockPixels];
  alignas(64) float distance[kBlockPixels];
  alignas(64) float expected[kBlockPixels];
  alignas(64) float median[kBlockPixels];
};

/// Rays of a block's pixels (z = 1) and 0.1 |ray|, below which the slope to a plane counts as grazing.
struct BlockRays {
  alignas(64) float x[kBlockPixels], y[kBlockPixels], grazing[kBlockPixels];
};
void block_rays(const BlockWeights& block, const ProjectionCamera<float>& camera, BlockRays& rays);

/// Without `geometry` only colour and alpha are written.
void blend_block_forward(const TileWeights& tile, const BlockWeights& block, const ProjectionCamera<float>& camera,
                         const RasterSettings& raster, bool geometry, BlockMaps& maps);

}  // namespace aligngs::cpu
