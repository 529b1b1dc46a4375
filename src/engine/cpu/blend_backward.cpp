#include "engine/cpu/blend_backward.h"

#include "engine/cpu/simd_targets.h"
#include "engine/formulas/blending.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/blend_backward.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/intersection-inl.h"
#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Moments of g in whitened coordinates.
struct Moments {
  FloatVec p, r, one, pp, pr, rr;
};
HWY_INLINE Moments zero_moments() {
  const FloatVec zero = hn::Zero(FloatTag());
  return {zero, zero, zero, zero, zero, zero};
}
HWY_INLINE void add_moments(FloatVec g, FloatVec p, FloatVec r, Moments& m) {
  const FloatVec gp = hn::Mul(g, p), gr = hn::Mul(g, r);
  m.one = hn::Add(m.one, g);
  m.p = hn::Add(m.p, gp);
  m.r = hn::Add(m.r, gr);
  m.pp = hn::MulAdd(gp, p, m.pp);
  m.pr = hn::MulAdd(gp, r, m.pr);
  m.rr = hn::MulAdd(gr, r, m.rr);
}

/// Rays and centres of a tile's pixels.
struct TileRays {
  HWY_ALIGN float x[kTilePixels], y[kTilePixels];  ///< pixels
  // With density only; the range of depths that the prior supports is empty where there is none.
  HWY_ALIGN float ray_x[kTilePixels], ray_y[kTilePixels], grazing[kTilePixels];
  HWY_ALIGN float supported_from[kTilePixels], supported_to[kTilePixels];
};
void tile_rays(const TileWeights& tile, const ProjectionCamera<float>& camera, bool density, const TileGradients& in,
               TileRays& out) {
  const FloatTag d;
  const FloatVec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (size_t at = 0; at < kTilePixels; at += kLanes) {
    const BlockWeights& block = tile.blocks[at / kBlockPixels];
    const FloatVec x = pixel_centres_x(block.x, at % kBlockPixels), y = pixel_centres_y(block.y, at % kBlockPixels);
    hn::Store(x, d, out.x + at);
    hn::Store(y, d, out.y + at);
    if (!density) continue;
    const RayLanes ray = ray_lanes(camera, x, y);
    hn::Store(ray.x, d, out.ray_x + at);
    hn::Store(ray.y, d, out.ray_y + at);
    hn::Store(ray.grazing, d, out.grazing + at);
    const FloatVec prior = hn::Load(d, in.prior + at);
    const auto known = hn::Gt(prior, zero);
    hn::Store(hn::IfThenElse(known, hn::Mul(prior, hn::Set(d, float(1 - kPriorSupport))), one), d,
              out.supported_from + at);
    hn::Store(hn::IfThenElseZero(known, hn::Mul(prior, hn::Set(d, float(1 + kPriorSupport)))), d,
              out.supported_to + at);
  }
}

/// The blend behind the current Gaussian, per pixel.
struct Behind {
  HWY_ALIGN float color[kTilePixels];
  HWY_ALIGN float all[kTilePixels];
  HWY_ALIGN float semantic[kTilePixels];
};
void start_behind(const RasterSettings& raster, const TileGradients& in, Behind& behind) {
  const FloatTag d;
  for (size_t s = 0; s < kTilePixels; s += kLanes) {
    FloatVec b = hn::Mul(hn::Set(d, raster.background[0]), hn::Load(d, in.color[0] + s));
    b = hn::MulAdd(hn::Set(d, raster.background[1]), hn::Load(d, in.color[1] + s), b);
    b = hn::MulAdd(hn::Set(d, raster.background[2]), hn::Load(d, in.color[2] + s), b);
    hn::Store(b, d, behind.color + s);
    hn::Store(b, d, behind.all + s);
    hn::Store(hn::Zero(d), d, behind.semantic + s);
  }
}

/// q where a block has no coupling.
HWY_ALIGN constexpr float kNoCoupling[kBlockPixels] = {};

/// The strips of a tile that took one Gaussian after the other, from the back. Almost free of branches: how many strips
/// a Gaussian has cannot be foreseen, and every wrong guess costs as much as a strip.
class StripCursor {
 public:
  StripCursor(const TileWeights& tile, const BackwardOptions& options) : coupling_rows_(options.coupling_rows) {
    const float* const* coupling = options.coupling;
    for (size_t b = 0; b < kTileBlocks; ++b) {
      const BlockWeights& block = tile.blocks[b];
      left_[b] = block.count;
      entries_[b] = block.entry.data();
      sets_[b] = block.strips.data();
      weight_[b] = block.weight.data();
      alpha_[b] = block.alpha.data();
      gain_[b] = block.gain.data();
      coupling_[b] = coupling[b] != nullptr ? coupling[b] : kNoCoupling;
      coupled_[b] = coupling[b] != nullptr ? kBlockPixels : 0;
    }
  }
  /// The set of strips of Gaussian `index`; to be called for all of them, from the last on.
  uint32_t strips_of(uint32_t index) {
    uint32_t set = 0;
    if (coupling_rows_ != nullptr) row_ = coupling_rows_[index];
    for (size_t b = 0; b < kTileBlocks; ++b) {
      if (left_[b] == 0) continue;
      const size_t e = left_[b] - 1;
      const bool here = entries_[b][e] == index;
      const uint32_t strips = here ? sets_[b][e] : 0u;  // apart: GCC 12's shift sanitizer loses `b` in one expression
      set |= strips << (b * kBlockStrips);
      entry_[b] = e;
      left_[b] = here ? e : left_[b];
    }
    return set;
  }
  /// Values of the Gaussian in the block of a strip; `at` is the strip's first pixel as a number of the tile.
  const float* weight(size_t at) const { return weight_[at / kBlockPixels] + offset(at); }
  const float* alpha(size_t at) const { return alpha_[at / kBlockPixels] + offset(at); }
  const float* gain(size_t at) const { return gain_[at / kBlockPixels] + offset(at); }
  const float* coupling(size_t at) const {
    const size_t b = at / kBlockPixels;
    return coupling_[b] + (coupling_rows_ != nullptr ? row_ : entry_[b]) * coupled_[b] + at % kBlockPixels;
  }

 private:
  size_t offset(size_t at) const { return entry_[at / kBlockPixels] * kBlockPixels + at % kBlockPixels; }

  const uint32_t* coupling_rows_;
  size_t row_ = 0;
  size_t left_[kTileBlocks], entry_[kTileBlocks] = {}, coupled_[kTileBlocks];
  const uint32_t* entries_[kTileBlocks];
  const uint8_t* sets_[kTileBlocks];
  const float *weight_[kTileBlocks], *alpha_[kTileBlocks], *gain_[kTileBlocks], *coupling_[kTileBlocks];
};

/// The Gaussian's place in the image, in every lane.
struct SplatLanes {
  FloatVec x, y, fxx, fxy, fyy;
  explicit SplatLanes(const Splat& g)
      : x(hn::Set(FloatTag(), g.x)),
        y(hn::Set(FloatTag(), g.y)),
        fxx(hn::Set(FloatTag(), g.fxx)),
        fxy(hn::Set(FloatTag(), g.fxy)),
        fyy(hn::Set(FloatTag(), g.fyy)) {}
  /// The whitened offset of the pixels from number `at` on.
  HWY_INLINE void offset(const TileRays& rays, size_t at, FloatVec& p, FloatVec& r) const {
    const FloatTag d;
    const FloatVec dx = hn::Sub(hn::Load(d, rays.x + at), x), dy = hn::Sub(hn::Load(d, rays.y + at), y);
    p = hn::MulAdd(fxy, dy, hn::Mul(fxx, dx));
    r = hn::Mul(fyy, dy);
  }
};

template <bool kGeometry, bool kDensity, bool kCoupling, bool kSmooth>
void sweep(const TileWeights& tile, const TileRays& rays, const RasterSettings& raster, const TileGradients& in,
           const BackwardOptions& options, const TileSlots& out) {
  const FloatTag d;
  const FloatVec zero = hn::Zero(d), alpha_max = hn::Set(d, raster.alpha_max);
  Behind behind;
  start_behind(raster, in, behind);
  StripCursor cursor(tile, options);
  HWY_ALIGN float sums[kCoupledSplatGradientFloats];
  for (size_t i = tile.count; i-- > 0;) {
    const Splat& g = tile.splats[i];
    FloatVec c0 = zero, c1 = zero, c2 = zero, w_sum = zero, n0 = zero, n1 = zero, n2 = zero, dist = zero;
    FloatVec residual = zero, unsupported = zero;
    Moments all = zero_moments(), semantic = zero_moments();
    FloatVec photo_p = zero, photo_r = zero, abs_p = zero, abs_y = zero;
    const SplatLanes lanes(g);
    for (uint32_t left = cursor.strips_of(static_cast<uint32_t>(i)); left != 0; left &= left - 1) {
      const size_t first = hwy::Num0BitsBelowLS1Bit_Nonzero32(left) * static_cast<size_t>(kStripPixels);
      const float *weight = cursor.weight(first), *alpha = cursor.alpha(first);
      for (size_t s = 0; s < kStripPixels; s += kLanes) {
        const size_t at = first + s;
        const FloatVec w = hn::Load(d, weight + s);
        c0 = hn::MulAdd(w, hn::Load(d, in.color[0] + at), c0);
        c1 = hn::MulAdd(w, hn::Load(d, in.color[1] + at), c1);
        c2 = hn::MulAdd(w, hn::Load(d, in.color[2] + at), c2);
        w_sum = hn::Add(w_sum, w);
        if constexpr (kGeometry) {
          n0 = hn::MulAdd(w, hn::Load(d, in.normal[0] + at), n0);
          n1 = hn::MulAdd(w, hn::Load(d, in.normal[1] + at), n1);
          n2 = hn::MulAdd(w, hn::Load(d, in.normal[2] + at), n2);
          dist = hn::MulAdd(w, hn::Load(d, in.distance + at), dist);
        }
        if constexpr (kDensity) {
          residual = hn::MulAdd(w, hn::Load(d, in.residual + at), residual);
          const FloatVec z = intersection(d, g, hn::Load(d, rays.ray_x + at), hn::Load(d, rays.ray_y + at),
                                          hn::Load(d, rays.grazing + at));
          const auto supported =
              hn::And(hn::Ge(z, hn::Load(d, rays.supported_from + at)), hn::Le(z, hn::Load(d, rays.supported_to + at)));
          unsupported = hn::Add(unsupported, hn::IfThenZeroElse(supported, w));
        }
        const FloatVec a = hn::Load(d, alpha + s);
        FloatVec slope;  // T d alpha / d power
        if constexpr (kSmooth) {
          slope = hn::Load(d, cursor.gain(first) + s);
        } else {
          slope = hn::IfThenElseZero(hn::Lt(a, alpha_max), w);
        }
        FloatVec p, r;
        lanes.offset(rays, at, p, r);
        FloatVec v = hn::Mul(hn::Set(d, g.color[0]), hn::Load(d, in.color[0] + at));
        v = hn::MulAdd(hn::Set(d, g.color[1]), hn::Load(d, in.color[1] + at), v);
        v = hn::MulAdd(hn::Set(d, g.color[2]), hn::Load(d, in.color[2] + at), v);
        const FloatVec behind_color = hn::Load(d, behind.color + at);
        const FloatVec step_color = hn::Sub(v, behind_color);
        hn::Store(hn::MulAdd(a, step_color, behind_color), d, behind.color + at);
        const FloatVec g_color = hn::Mul(slope, step_color);
        FloatVec g_all = g_color;
        if constexpr (kGeometry) {
          v = hn::MulAdd(hn::Set(d, g.normal[0]), hn::Load(d, in.normal[0] + at), v);
          v = hn::MulAdd(hn::Set(d, g.normal[1]), hn::Load(d, in.normal[1] + at), v);
          v = hn::MulAdd(hn::Set(d, g.normal[2]), hn::Load(d, in.normal[2] + at), v);
          v = hn::Add(hn::MulAdd(hn::Set(d, g.distance), hn::Load(d, in.distance + at), v), hn::Load(d, in.alpha + at));
          const FloatVec behind_all = hn::Load(d, behind.all + at);
          const FloatVec step = hn::Sub(v, behind_all);
          hn::Store(hn::MulAdd(a, step, behind_all), d, behind.all + at);
          g_all = hn::Mul(slope, step);
        }
        add_moments(g_all, p, r, all);
        if constexpr (kGeometry) {
          photo_p = hn::MulAdd(g_color, p, photo_p);
          photo_r = hn::MulAdd(g_color, r, photo_r);
        }
        if constexpr (kDensity) {
          abs_p = hn::Add(abs_p, hn::Abs(hn::Mul(g_color, p)));
          abs_y = hn::Add(abs_y, hn::Abs(hn::Mul(g_color, hn::MulAdd(lanes.fxy, p, hn::Mul(lanes.fyy, r)))));
        }
        if constexpr (kCoupling) {
          const FloatVec back = hn::Load(d, behind.semantic + at);
          const FloatVec step = hn::Sub(hn::Load(d, cursor.coupling(first) + s), back);
          hn::Store(hn::MulAdd(a, step, back), d, behind.semantic + at);
          add_moments(hn::Mul(slope, step), p, r, semantic);
        }
      }
    }
    {
      const FloatVec first[16] = {c0,    c1,    c2,      w_sum,  n0,     n1,     n2,       dist,
                                  all.p, all.r, all.one, all.pp, all.pr, all.rr, residual, unsupported};
      store_lane_sums(first, sums);
    }
    if constexpr (!kGeometry) {
      photo_p = all.p;
      photo_r = all.r;
    }
    const FloatVec second[16] = {photo_p,      photo_r,     abs_p,       abs_y,       semantic.p, semantic.r,
                                 semantic.one, semantic.pp, semantic.pr, semantic.rr, zero,       zero,
                                 zero,         zero,        zero,        zero};
    store_lane_sums(second, sums + 16);
    // Whole cache lines that nobody reads before the sweep ends: past the caches.
    float* to = reinterpret_cast<float*>(
        out.slots + static_cast<size_t>(g.slot_origin + int64_t(out.tile_y) * g.slot_stride + out.tile_x));
    for (size_t k = 0; k < kCoupledSplatGradientFloats; k += kLanes) hn::Stream(hn::Load(d, sums + k), d, to + k);
  }
  hwy::FlushStream();
}

template <bool kGeometry, bool kDensity, bool kSmooth = false>
void sweep_with(const TileWeights& tile, const TileRays& rays, const RasterSettings& raster, const TileGradients& in,
                const BackwardOptions& options, const TileSlots& out) {
  bool any = false;
  for (int b = 0; b < kTileBlocks; ++b) any |= options.coupling[b] != nullptr;
  if (any) {
    sweep<kGeometry, kDensity, true, kSmooth>(tile, rays, raster, in, options, out);
  } else {
    sweep<kGeometry, kDensity, false, kSmooth>(tile, rays, raster, in, options, out);
  }
}

void BlendTileBackward(const TileWeights& tile, const ProjectionCamera<float>& camera, const RasterSettings& raster,
                       const TileGradients& in, const BackwardOptions& options, const TileSlots& out) {
  TileRays rays;
  tile_rays(tile, camera, options.density || raster.smooth_cutoff, in, rays);
  if (raster.smooth_cutoff) {  // for tests: one version that computes everything
    sweep_with<true, true, true>(tile, rays, raster, in, options, out);
  } else if (options.geometry && options.density) {
    sweep_with<true, true>(tile, rays, raster, in, options, out);
  } else if (options.geometry) {
    sweep_with<true, false>(tile, rays, raster, in, options, out);
  } else if (options.density) {
    sweep_with<false, true>(tile, rays, raster, in, options, out);
  } else {
    sweep_with<false, false>(tile, rays, raster, in, options, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(BlendTileBackward);

void blend_tile_backward(const TileWeights& tile, const ProjectionCamera<float>& camera, const RasterSettings& raster,
                         const TileGradients& gradients, const BackwardOptions& options, const TileSlots& out) {
  HWY_DYNAMIC_DISPATCH(BlendTileBackward)(tile, camera, raster, gradients, options, out);
}

}  // namespace aligngs::cpu
#endif
