#include "engine/cpu/tile_weights.h"

#include <cmath>

#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/tile_weights.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/alpha-inl.h"
#include "engine/cpu/intersection-inl.h"
#include "engine/cpu/overlap-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Splats gathered before the blocks are asked whether they still need more: most tiles end within one or two.
constexpr size_t kGather = 256;
/// How far ahead the gather asks for a splat: a miss of the last-level cache lasts about this many copies.
constexpr size_t kPrefetch = 12;

/// Sets bit b of masks[i] when splats[i] can reach alpha_min at a pixel centre of block b of the tile.
void block_masks(const Splat* splats, size_t count, float tile_x, float tile_y, uint8_t* masks) {
  const hn::RebindToSigned<FloatTag> di;
  HWY_ALIGN int32_t bits[kLanes];
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t n = HWY_MIN(kLanes, count - first);
    const OverlapLanes lanes = overlap_lanes(splats + first, n);
    auto mask = hn::Zero(di);
    const BoxColumns columns[2] = {box_columns(lanes, tile_x, kBlockSize),
                                   box_columns(lanes, tile_x + kBlockSize, kBlockSize)};
    const BoxRows rows[2] = {box_rows(lanes, tile_y, kBlockSize), box_rows(lanes, tile_y + kBlockSize, kBlockSize)};
    for (int b = 0; b < kTileBlocks; ++b) {
      const auto hit = reaches_box(lanes, columns[b & 1], rows[b >> 1]);
      mask = hn::Or(mask, hn::IfThenElseZero(hn::RebindMask(di, hit), hn::Set(di, 1 << b)));
    }
    hn::Store(mask, di, bits);
    for (size_t i = 0; i < n; ++i) masks[first + i] = static_cast<uint8_t>(bits[i]);
  }
}

/// Blends the candidates of a block. Formulas of engine/formulas/blending.h, 64 pixels at a time. On entry and exit
/// block.transmittance is negative where a pixel takes no more: then T (1 - alpha) < transmittance_min for any alpha.
template <bool kSmooth>
void blend_candidates(const Splat* splats, const AlphaConstants& constants, BlockWeights& block, size_t candidates) {
  const FloatTag d;
  constexpr size_t kStrips = kBlockPixels / kLanes;
  block.entry.resize(block.count + candidates);
  block.alpha.resize((block.count + candidates) * kBlockPixels);
  block.weight.resize((block.count + candidates) * kBlockPixels);
  if (kSmooth) block.gain.resize((block.count + candidates) * kBlockPixels);
  block.strips.resize(block.count + candidates);
  const FloatVec zero = hn::Zero(d);
  FloatVec t[kStrips];
  for (size_t s = 0; s < kStrips; ++s) t[s] = hn::Load(d, block.transmittance + s * kLanes);
  bool open = true;
  for (size_t i = 0; i < candidates && open; ++i) {
    const uint32_t index = block.candidates[i];
    const Splat& g = splats[index];
    float* HWY_RESTRICT out_alpha = block.alpha.data() + block.count * kBlockPixels;
    float* HWY_RESTRICT out_weight = block.weight.data() + block.count * kBlockPixels;
    FloatVec most_left = zero;
    uint32_t strips = 0;
    const FloatVec x = hn::Set(d, g.x), fxx = hn::Set(d, g.fxx);
    FloatVec fdx = hn::Mul(fxx, hn::Sub(pixel_centres_x(block.x, 0), x));  // the same for all vectors of whole rows
    for (size_t s = 0; s < kStrips; ++s) {
      const size_t at = s * kLanes;
      if (kLanes < kBlockSize) fdx = hn::Mul(fxx, hn::Sub(pixel_centres_x(block.x, at), x));
      const FloatVec before = t[s];
      const AlphaLanes a = alpha_lanes<kSmooth>(g, fdx, pixel_centres_y(block.y, at), constants, t[s]);
      hn::Store(a.alpha, d, out_alpha + at);
      hn::Store(hn::Mul(a.alpha, before), d, out_weight + at);
      if constexpr (kSmooth) {
        float* out_gain = block.gain.data() + block.count * kBlockPixels;
        hn::Store(hn::IfThenElseZero(a.taken, hn::Mul(a.slope, before)), d, out_gain + at);
      }
      most_left = hn::Max(most_left, t[s]);
      strips |= static_cast<uint32_t>(!hn::AllFalse(d, a.taken)) << (at / kStripPixels);
    }
    block.entry[block.count] = index;
    block.strips[block.count] = static_cast<uint8_t>(strips);
    block.count += strips != 0 ? 1 : 0;
    open = !hn::AllFalse(d, hn::Gt(most_left, zero));
  }
  for (size_t s = 0; s < kStrips; ++s) hn::Store(t[s], d, block.transmittance + s * kLanes);
  block.open = open;
}

void ComputeTileWeights(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                        const RasterSettings& raster, TileWeights& out) {
  const size_t tile = size_t(tile_y) * view.tiles_x + tile_x;
  const uint32_t* list = lists.gaussians.data() + lists.tile_begin[tile];
  const size_t length = static_cast<size_t>(lists.tile_begin[tile + 1] - lists.tile_begin[tile]);
  const AlphaConstants constants(raster);
  out.count = 0;
  bool open = false;
  for (int b = 0; b < kTileBlocks; ++b) {
    BlockWeights& block = out.blocks[b];
    block.x = tile_x * kTileSize + (b & 1) * kBlockSize;
    block.y = tile_y * kTileSize + (b >> 1) * kBlockSize;
    block.count = 0;
    block.open = false;
    for (int i = 0; i < kBlockPixels; ++i) {
      const bool inside = block.x + i % kBlockSize < view.width && block.y + i / kBlockSize < view.height;
      block.transmittance[i] = inside ? 1.0f : -1.0f;
      block.open |= inside;
    }
    open |= block.open;
  }
  uint8_t masks[kGather];
  for (size_t first = 0; first < length && open; first += kGather) {
    const size_t n = HWY_MIN(kGather, length - first);
    out.splats.resize(out.count + n);
    out.rows.resize(out.count + n);
    Splat* gathered = out.splats.data() + out.count;
    for (size_t i = 0; i < n; ++i) {
      const size_t ahead = first + i + kPrefetch;
      if (ahead < length) {
        const char* next = reinterpret_cast<const char*>(&view.splats[list[ahead]]);
        hwy::Prefetch(next);
        hwy::Prefetch(next + 64);
      }
      gathered[i] = view.splats[list[first + i]];
    }
    block_masks(gathered, n, static_cast<float>(tile_x * kTileSize), static_cast<float>(tile_y * kTileSize), masks);
    size_t candidates[kTileBlocks] = {};
    size_t kept = 0;
    for (int b = 0; b < kTileBlocks; ++b) out.blocks[b].candidates.resize(kGather);
    for (size_t i = 0; i < n; ++i) {
      const uint32_t index = static_cast<uint32_t>(out.count + kept);
      for (int b = 0; b < kTileBlocks; ++b) {
        out.blocks[b].candidates[HWY_MIN(candidates[b], kGather - 1)] = index;
        candidates[b] += (masks[i] >> b) & 1u;
      }
      gathered[kept] = gathered[i];
      out.rows[out.count + kept] = list[first + i];
      kept += masks[i] != 0;
    }
    out.count += kept;
    open = false;
    for (int b = 0; b < kTileBlocks; ++b) {
      BlockWeights& block = out.blocks[b];
      if (block.open && candidates[b] > 0) {
        if (raster.smooth_cutoff) {
          blend_candidates<true>(out.splats.data(), constants, block, candidates[b]);
        } else {
          blend_candidates<false>(out.splats.data(), constants, block, candidates[b]);
        }
      }
      open |= block.open;
    }
  }
  for (BlockWeights& block : out.blocks) {
    for (float& t : block.transmittance) t = std::fabs(t);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(ComputeTileWeights);

void compute_tile_weights(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                          const RasterSettings& raster, TileWeights& out) {
  HWY_DYNAMIC_DISPATCH(ComputeTileWeights)(view, lists, tile_x, tile_y, raster, out);
}

}  // namespace aligngs::cpu
#endif
