#include "engine/cpu/tile_weights.h"

#include <cmath>

#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/tile_weights.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Splats gathered before the blocks are asked whether they still need more: most tiles end within one or two.
constexpr size_t kGather = 256;
/// How far ahead the gather asks for a splat: a miss of the last-level cache lasts about this many copies.
constexpr size_t kPrefetch = 12;
/// Slack of the overlap test, relative and absolute: it only bounds the work, the alpha test decides.
constexpr float kLevelFactor = 1.001f, kLevelMargin = 1e-3f;

/// Sets bit b of masks[i] when splats[i] can reach alpha_min at a pixel centre of block b of the tile.
/// The form p^2 + r^2 is convex, so over a box that does not hold the mean its minimum lies on the nearest
/// vertical or horizontal edge.
void block_masks(const Splat* splats, size_t count, float tile_x, float tile_y, uint8_t* masks) {
  const FloatTag d;
  HWY_ALIGN float fields[6][kLanes];
  const FloatVec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t n = HWY_MIN(kLanes, count - first);
    for (size_t i = 0; i < kLanes; ++i) {
      const Splat& s = splats[first + HWY_MIN(i, n - 1)];
      fields[0][i] = s.x;
      fields[1][i] = s.y;
      fields[2][i] = s.fxx;
      fields[3][i] = s.fxy;
      fields[4][i] = s.fyy;
      fields[5][i] = s.level;
    }
    const FloatVec x = hn::Load(d, fields[0]), y = hn::Load(d, fields[1]);
    const FloatVec fxx = hn::Load(d, fields[2]), fxy = hn::Load(d, fields[3]), fyy = hn::Load(d, fields[4]);
    const FloatVec level = hn::MulAdd(hn::Load(d, fields[5]), hn::Set(d, kLevelFactor), hn::Set(d, kLevelMargin));
    const FloatVec along_y = hn::Div(hn::Mul(fxx, fxy), hn::MulAdd(fxy, fxy, hn::Mul(fyy, fyy)));
    const FloatVec along_x = hn::Div(fxy, fxx);
    HWY_ALIGN float hit[kTileBlocks][kLanes];
    for (int b = 0; b < kTileBlocks; ++b) {
      const float left = tile_x + (b & 1) * kBlockSize + 0.5f, top = tile_y + (b >> 1) * kBlockSize + 0.5f;
      const FloatVec x0 = hn::Sub(hn::Set(d, left), x), x1 = hn::Sub(hn::Set(d, left + kBlockSize - 1), x);
      const FloatVec y0 = hn::Sub(hn::Set(d, top), y), y1 = hn::Sub(hn::Set(d, top + kBlockSize - 1), y);
      const FloatVec ex = hn::Min(hn::Max(zero, x0), x1), ey = hn::Min(hn::Max(zero, y0), y1);  // nearest to the mean
      // On x = ex the best y is -ex fxx fxy / (fxy^2 + fyy^2); on y = ey the best x is -ey fxy / fxx.
      const FloatVec vy = hn::Min(hn::Max(hn::Neg(hn::Mul(ex, along_y)), y0), y1);
      const FloatVec hx = hn::Min(hn::Max(hn::Neg(hn::Mul(ey, along_x)), x0), x1);
      const FloatVec vp = hn::MulAdd(fxx, ex, hn::Mul(fxy, vy)), vr = hn::Mul(fyy, vy);
      const FloatVec hp = hn::MulAdd(fxx, hx, hn::Mul(fxy, ey)), hr = hn::Mul(fyy, ey);
      const FloatVec vertical = hn::MulAdd(vp, vp, hn::Mul(vr, vr)), horizontal = hn::MulAdd(hp, hp, hn::Mul(hr, hr));
      const FloatVec smallest = hn::Min(vertical, horizontal);
      hn::Store(hn::IfThenElseZero(hn::Le(smallest, level), one), d, hit[b]);
    }
    for (size_t i = 0; i < n; ++i) {
      uint8_t mask = 0;
      for (int b = 0; b < kTileBlocks; ++b) mask |= static_cast<uint8_t>(hit[b][i] != 0 ? 1u << b : 0u);
      masks[first + i] = mask;
    }
  }
}

/// Constants of the alpha test.
struct AlphaConstants {
  float alpha_min, alpha_max, transmittance_min;
  bool smooth;
};

/// Blends the candidates of a block. Formulas of engine/formulas/blending.h, 64 pixels at a time. On entry and exit
/// block.transmittance is negative where a pixel takes no more: then T (1 - alpha) < transmittance_min for any alpha.
template <bool kSmooth>
void blend_candidates(const Splat* splats, const AlphaConstants& constants, BlockWeights& block, size_t candidates) {
  const FloatTag d;
  constexpr size_t kStrips = kBlockPixels / kLanes;
  HWY_ALIGN float pixel_x[kBlockPixels], pixel_y[kBlockPixels];
  for (int i = 0; i < kBlockPixels; ++i) {
    pixel_x[i] = block.x + (i % kBlockSize) + 0.5f;
    pixel_y[i] = block.y + (i / kBlockSize) + 0.5f;
  }
  block.entry.resize(block.count + candidates);
  block.alpha.resize((block.count + candidates) * kBlockPixels);
  block.weight.resize((block.count + candidates) * kBlockPixels);
  if (kSmooth) block.gain.resize((block.count + candidates) * kBlockPixels);
  block.strips.resize(block.count + candidates);
  const FloatVec alpha_min = hn::Set(d, constants.alpha_min), alpha_max = hn::Set(d, constants.alpha_max);
  const FloatVec t_min = hn::Set(d, constants.transmittance_min), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const FloatVec sign = hn::Set(d, -0.0f);
  FloatVec t[kStrips];
  for (size_t s = 0; s < kStrips; ++s) t[s] = hn::Load(d, block.transmittance + s * kLanes);
  bool open = true;
  for (size_t i = 0; i < candidates && open; ++i) {
    const uint32_t index = block.candidates[i];
    const Splat& g = splats[index];
    const FloatVec gx = hn::Set(d, g.x), gy = hn::Set(d, g.y), fxx = hn::Set(d, g.fxx), fxy = hn::Set(d, g.fxy),
                   fyy = hn::Set(d, g.fyy), opacity = hn::Set(d, g.opacity);
    float* HWY_RESTRICT out_alpha = block.alpha.data() + block.count * kBlockPixels;
    float* HWY_RESTRICT out_weight = block.weight.data() + block.count * kBlockPixels;
    FloatVec most_left = zero;
    uint32_t strips = 0;
    FloatVec fdx = hn::Mul(fxx, hn::Sub(hn::Load(d, pixel_x), gx));  // the same for all vectors of whole rows
    for (size_t s = 0; s < kStrips; ++s) {
      if (kLanes < kBlockSize) fdx = hn::Mul(fxx, hn::Sub(hn::Load(d, pixel_x + s * kLanes), gx));
      const FloatVec dy = hn::Sub(hn::Load(d, pixel_y + s * kLanes), gy);
      const FloatVec p = hn::MulAdd(fxy, dy, fdx), r = hn::Mul(fyy, dy);
      const FloatVec raw = hn::Mul(opacity, fast_exp2(d, hn::NegMulSub(p, p, hn::Mul(r, r))));
      FloatVec alpha = hn::Min(raw, alpha_max);
      FloatVec slope = raw;  // d alpha / d power
      if constexpr (kSmooth) {
        const FloatVec ramp_t = hn::Sub(hn::Div(raw, alpha_min), one);
        const auto on_ramp = hn::Lt(ramp_t, one);
        const FloatVec ramp =
            hn::Mul(hn::Mul(ramp_t, ramp_t), hn::NegMulAdd(hn::Set(d, 2.0f), ramp_t, hn::Set(d, 3.0f)));
        const FloatVec steep =
            hn::Div(hn::Mul(hn::Mul(hn::Set(d, 6.0f), raw), hn::Mul(ramp_t, hn::Sub(one, ramp_t))), alpha_min);
        alpha = hn::IfThenElse(on_ramp, hn::Mul(raw, ramp), alpha);
        slope = hn::IfThenElse(on_ramp, hn::Mul(raw, hn::Add(ramp, steep)), slope);
        slope = hn::IfThenElseZero(hn::Le(raw, alpha_max), slope);
      }
      const FloatVec next = hn::NegMulAdd(alpha, t[s], t[s]);
      const auto wanted = hn::Ge(raw, alpha_min);
      const auto taken = hn::And(wanted, hn::Ge(next, t_min));
      alpha = hn::IfThenElseZero(taken, alpha);
      hn::Store(alpha, d, out_alpha + s * kLanes);
      hn::Store(hn::Mul(alpha, t[s]), d, out_weight + s * kLanes);
      if constexpr (kSmooth) {
        float* out_gain = block.gain.data() + block.count * kBlockPixels;
        hn::Store(hn::IfThenElseZero(taken, hn::Mul(slope, t[s])), d, out_gain + s * kLanes);
      }
      t[s] = hn::IfThenElse(taken, next, hn::IfThenElse(wanted, hn::Or(t[s], sign), t[s]));
      most_left = hn::Max(most_left, t[s]);
      strips |= static_cast<uint32_t>(!hn::AllFalse(d, taken)) << (s * kLanes / kStripPixels);
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
  const AlphaConstants constants{raster.alpha_min, raster.alpha_max, raster.transmittance_min, raster.smooth_cutoff};
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
        if (constants.smooth) {
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
