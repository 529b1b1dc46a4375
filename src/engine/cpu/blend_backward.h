// From gradients of a tile's maps to sums per Gaussian.
#pragma once

#include "engine/cpu/tile_weights.h"
#include "engine/formulas/projection.h"
#include "engine/shared/splat_gradient.h"

namespace aligngs::cpu {

/// The sums of one Gaussian in one tile, and the same moments of the semantic coupling.
struct alignas(64) CoupledSplatGradient {
  SplatGradient maps;  ///< of losses of the maps
  float coupling_p, coupling_r, coupling_one, coupling_pp, coupling_pr, coupling_rr;
  float unused[6];
};
inline constexpr size_t kCoupledSplatGradientFloats = sizeof(CoupledSplatGradient) / sizeof(float);
static_assert(kCoupledSplatGradientFloats == 32,
              "two cache lines of their own: they are written to any place in memory");

/// dL / d maps of a tile, block after block, and what density statistics need of its pixels. Zero outside the image.
struct TileGradients {
  alignas(64) float color[3][kTilePixels];
  alignas(64) float normal[3][kTilePixels];
  alignas(64) float distance[kTilePixels];
  alignas(64) float alpha[kTilePixels];
  alignas(64) float residual[kTilePixels];  ///< mean absolute colour difference
  alignas(64) float prior[kTilePixels];     ///< prior depth, 0 = none
};

struct BackwardOptions {
  bool geometry = false;  ///< some loss reached normal, distance or alpha
  bool density = false;   ///< collect weight, residual, unsupported and the absolute sums
  /// Per block [rows][64] q_k of the semantic coupling; nullptr: none.
  const float* coupling[kTileBlocks] = {};
  /// [TileWeights::count] the splat's row of q; nullptr: that of its entry in the block.
  const uint32_t* coupling_rows = nullptr;
};

/// Destination of the sums of the tile's Gaussians: slots[slot of the instance], see Splat.
struct TileSlots {
  CoupledSplatGradient* slots;
  int tile_x, tile_y;
};

/// Writes the sums of all Gaussians of the tile.
///
/// Sweeps from the back: with v_k the value of Gaussian k (dL/dmaps . its values) and B_k the blend behind it,
///   B_{k-1} = alpha_k v_k + (1 - alpha_k) B_k,   dL/dalpha_k = T_k (v_k - B_k),
/// starting with the background. Unlike total-minus-prefix this neither divides by 1 - alpha nor cancels where T is
/// small. The weights are known (tile_weights.h), so the order of the sweep is free. A Gaussian's sums stay in
/// registers over all its strips of the tile.
void blend_tile_backward(const TileWeights& tile, const ProjectionCamera<float>& camera, const RasterSettings& raster,
                         const TileGradients& gradients, const BackwardOptions& options, const TileSlots& out);

}  // namespace aligngs::cpu
