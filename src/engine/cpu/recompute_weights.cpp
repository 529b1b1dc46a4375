#include <cstring>

#include "engine/cpu/simd_targets.h"
#include "engine/cpu/tile_weights.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/recompute_weights.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/alpha-inl.h"
#include "engine/cpu/intersection-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// How far ahead the gather asks for a splat: a miss of the last-level cache lasts about this many copies.
constexpr size_t kRecordPrefetch = 12;

/// Entries `list` of the block in the pixels of one vector, whose first is number `at`. `last` as in BlendRecord.
template <bool kSmooth>
void blend_known(const TileWeights& tile, const uint32_t* list, size_t count, const int32_t* last,
                 const AlphaConstants& constants, size_t at, BlockWeights& block) {
  const FloatTag d;
  const hn::RebindToSigned<FloatTag> di;
  const FloatVec pixel_x = pixel_centres_x(block.x, at), pixel_y = pixel_centres_y(block.y, at);
  const auto end = hn::LoadU(di, last + at);
  FloatVec t = hn::Set(d, 1.0f);
  for (size_t i = 0; i < count; ++i) {
    const size_t e = list[i];
    const uint32_t index = block.entry[e];
    const Splat& g = tile.splats[index];
    const auto open = hn::RebindMask(d, hn::Lt(hn::Set(di, tile.places[index]), end));
    const FloatVec before = t;
    const FloatVec fdx = hn::Mul(hn::Set(d, g.fxx), hn::Sub(pixel_x, hn::Set(d, g.x)));
    const AlphaLanes a = alpha_lanes_within<kSmooth>(g, fdx, pixel_y, constants, open, t);
    hn::Store(a.alpha, d, block.alpha.data() + e * kBlockPixels + at);
    hn::Store(hn::Mul(a.alpha, before), d, block.weight.data() + e * kBlockPixels + at);
    if constexpr (kSmooth) {
      hn::Store(hn::IfThenElseZero(a.taken, hn::Mul(a.slope, before)), d, block.gain.data() + e * kBlockPixels + at);
    }
  }
  hn::Store(t, d, block.transmittance + at);
}

void RecomputeTileWeights(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                          const RasterSettings& raster, const BlendRecord& record, TileWeights& out) {
  const size_t tile = size_t(tile_y) * view.tiles_x + tile_x;
  const size_t begin = static_cast<size_t>(lists.tile_begin[tile]);
  const size_t length = static_cast<size_t>(lists.tile_begin[tile + 1]) - begin;
  const uint32_t* list = lists.gaussians.data() + begin;
  const uint16_t* strips = record.strips.data() + begin;
  const AlphaConstants constants(raster);
  const FloatTag d;
  out.places.resize(length + 1);
  size_t count = 0;
  for (size_t i = 0; i < length; ++i) {
    out.places[count] = static_cast<int32_t>(i);
    count += strips[i] != 0;
  }
  out.count = count;
  out.splats.resize(count);
  out.rows.resize(count);
  for (size_t k = 0; k < count; ++k) {
    if (k + kRecordPrefetch < count) {
      const char* next = reinterpret_cast<const char*>(&view.splats[list[out.places[k + kRecordPrefetch]]]);
      hwy::Prefetch(next);
      hwy::Prefetch(next + 64);
    }
    const uint32_t row = list[out.places[k]];
    out.rows[k] = row;
    out.splats[k] = view.splats[row];
  }
  for (int b = 0; b < kTileBlocks; ++b) {
    BlockWeights& block = out.blocks[b];
    block.x = tile_x * kTileSize + (b & 1) * kBlockSize;
    block.y = tile_y * kTileSize + (b >> 1) * kBlockSize;
    block.open = false;
    block.entry.resize(count + 1);
    block.strips.resize(count + 1);
    size_t entries = 0;
    for (size_t k = 0; k < count; ++k) {
      const unsigned set = (unsigned(strips[out.places[k]]) >> (b * kBlockStrips)) & ((1u << kBlockStrips) - 1u);
      block.entry[entries] = static_cast<uint32_t>(k);
      block.strips[entries] = static_cast<uint8_t>(set);
      entries += set != 0;
    }
    block.count = entries;
    block.alpha.resize(entries * kBlockPixels);
    block.weight.resize(entries * kBlockPixels);
    if (raster.smooth_cutoff) block.gain.resize(entries * kBlockPixels);
    block.candidates.resize(2 * (entries + 1));
    const int32_t* last = record.last.data() + tile * kTilePixels + b * kBlockPixels;
    for (int s = 0; s < kBlockStrips; ++s) {
      uint32_t *taken = block.candidates.data(), *missed = taken + entries + 1;
      size_t taken_count = 0, missed_count = 0;
      for (size_t e = 0; e < entries; ++e) {
        const unsigned bit = (unsigned(block.strips[e]) >> s) & 1u;
        taken[taken_count] = missed[missed_count] = static_cast<uint32_t>(e);
        taken_count += bit;
        missed_count += 1u - bit;
      }
      const size_t first = static_cast<size_t>(s) * kStripPixels;
      for (size_t i = 0; i < missed_count; ++i) {
        float* weight = block.weight.data() + missed[i] * size_t(kBlockPixels) + first;
        for (size_t at = 0; at < kStripPixels; at += kLanes) hn::Store(hn::Zero(d), d, weight + at);
      }
      for (size_t at = first; at < first + kStripPixels; at += kLanes) {
        if (raster.smooth_cutoff) {
          blend_known<true>(out, taken, taken_count, last, constants, at, block);
        } else {
          blend_known<false>(out, taken, taken_count, last, constants, at, block);
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(RecomputeTileWeights);

void recompute_tile_weights(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                            const RasterSettings& raster, const BlendRecord& record, TileWeights& out) {
  HWY_DYNAMIC_DISPATCH(RecomputeTileWeights)(view, lists, tile_x, tile_y, raster, record, out);
}

}  // namespace aligngs::cpu
#endif
