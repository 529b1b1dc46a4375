// The blending weights of a tile as one wants them, without Gaussians behind them.
#pragma once

#include <vector>

#include "core/random.h"
#include "engine/cpu/tile_weights.h"

namespace aligngs::cpu::testing_scene {

/// Gaussians of the tile's four blocks; each takes part in some of them.
struct TileOptions {
  size_t gaussians = 60;
  int channels = 150;
  double reach = 0.5;  ///< share of the blocks, and of a block's strips, that a Gaussian reaches
  double alpha_min = 0.1, alpha_max = 0.6;
  double spread = 2;           ///< standard deviation of the logits
  bool opaque_front = false;   ///< two Gaussians of alpha 0.95 before all others: T < 0.01 behind them
  bool silent_corner = false;  ///< the teacher says nothing in part of the tile
  bool trained = false;        ///< rows and teacher as after training: one of a few classes has nearly all of the mass
  SemanticBlend blend = SemanticBlend::kProbabilities;
  SemanticCoupling coupling = SemanticCoupling::kBounded;
};

/// One Gaussian of a block; a pixel that once had no room for one is full.
inline void add_entry(const TileOptions& options, Random& random, uint32_t gaussian, bool front,
                      std::vector<uint8_t>& full, BlockWeights& block) {
  const size_t first = block.count * kBlockPixels;
  uint8_t strips = 0;
  for (int strip = 0; strip < kBlockPixels / kStripPixels; ++strip) {
    const bool here = front || options.gaussians == 1 || random.chance(options.reach);
    for (int k = 0; k < kStripPixels; ++k) {
      const size_t i = static_cast<size_t>(strip * kStripPixels + k);
      const double alpha = front ? 0.95 : here ? random.uniform(options.alpha_min, options.alpha_max) : 0.0;
      const float t = block.transmittance[i], next = t * (1 - static_cast<float>(alpha));
      const bool taken = here && full[i] == 0 && next >= 1e-4f;
      full[i] |= here && !taken ? 1 : 0;
      block.alpha[first + i] = taken ? static_cast<float>(alpha) : 0.0f;
      block.weight[first + i] = taken ? static_cast<float>(alpha) * t : 0.0f;
      if (taken) block.transmittance[i] = next;
      if (taken) strips = static_cast<uint8_t>(strips | (1u << strip));
    }
  }
  block.entry[block.count] = gaussian;
  block.strips[block.count] = strips;
  block.count += strips != 0 ? 1 : 0;
}

/// Splats and weights of all blocks; the splats themselves say nothing but their slot.
inline void make_tile_weights(const TileOptions& options, Random& random, TileWeights& tile) {
  const size_t n = options.gaussians;
  tile.count = n;
  tile.splats.resize(n);
  tile.rows.resize(n);
  for (size_t i = 0; i < n; ++i) {
    tile.splats[i] = Splat{};
    tile.splats[i].slot_origin = static_cast<int64_t>(i);
    tile.rows[i] = static_cast<uint32_t>(i);
  }
  for (int b = 0; b < kTileBlocks; ++b) {
    BlockWeights& block = tile.blocks[b];
    block.x = (b & 1) * kBlockSize;
    block.y = (b >> 1) * kBlockSize;
    block.count = 0;
    block.entry.resize(n);
    block.alpha.resize(n * kBlockPixels);
    block.weight.resize(n * kBlockPixels);
    block.strips.resize(n);
    for (float& t : block.transmittance) t = 1;
    std::vector<uint8_t> full(kBlockPixels, 0);
    for (size_t i = 0; i < n; ++i) {
      const bool front = options.opaque_front && i < 2;
      if (!front && n > 1 && !random.chance(options.reach)) continue;
      add_entry(options, random, static_cast<uint32_t>(i), front, full, block);
    }
  }
}

}  // namespace aligngs::cpu::testing_scene
