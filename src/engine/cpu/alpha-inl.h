// The opacity of a Gaussian at a vector of pixels; compiled once per instruction set. Forward and backward share it, so
// that both see the same bits.
#if defined(ALIGNGS_ENGINE_CPU_ALPHA_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_ALPHA_INL_H_
#undef ALIGNGS_ENGINE_CPU_ALPHA_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_ALPHA_INL_H_
#endif

#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"
#include "engine/cpu/splats.h"
#include "engine/settings.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Constants of the alpha test.
struct AlphaConstants {
  FloatVec alpha_min, alpha_max, transmittance_min;
  explicit AlphaConstants(const RasterSettings& raster)
      : alpha_min(hn::Set(FloatTag(), raster.alpha_min)),
        alpha_max(hn::Set(FloatTag(), raster.alpha_max)),
        transmittance_min(hn::Set(FloatTag(), raster.transmittance_min)) {}
};

using FloatMask = hn::Mask<FloatTag>;

/// The effect of a Gaussian on a vector of pixels.
struct AlphaLanes {
  FloatVec alpha;  ///< 0 where it takes no part
  FloatVec slope;  ///< d alpha / d power, with the smooth cut-off only
  FloatMask taken;
};

/// Before it is known whether the pixel still takes anything.
struct RawAlpha {
  FloatVec alpha, slope;
  FloatMask wanted;  ///< alpha >= alpha_min
};
template <bool kSmooth>
HWY_INLINE RawAlpha raw_alpha(const Splat& g, FloatVec fdx, FloatVec pixel_y, const AlphaConstants& k) {
  const FloatTag d;
  const FloatVec one = hn::Set(d, 1.0f);
  const FloatVec dy = hn::Sub(pixel_y, hn::Set(d, g.y));
  const FloatVec p = hn::MulAdd(hn::Set(d, g.fxy), dy, fdx), r = hn::Mul(hn::Set(d, g.fyy), dy);
  const FloatVec raw = hn::Mul(hn::Set(d, g.opacity), fast_exp2(d, hn::NegMulSub(p, p, hn::Mul(r, r))));
  RawAlpha out{hn::Min(raw, k.alpha_max), raw, hn::Ge(raw, k.alpha_min)};
  if constexpr (kSmooth) {
    const FloatVec ramp_t = hn::Sub(hn::Div(raw, k.alpha_min), one);
    const auto on_ramp = hn::Lt(ramp_t, one);
    const FloatVec ramp = hn::Mul(hn::Mul(ramp_t, ramp_t), hn::NegMulAdd(hn::Set(d, 2.0f), ramp_t, hn::Set(d, 3.0f)));
    const FloatVec steep =
        hn::Div(hn::Mul(hn::Mul(hn::Set(d, 6.0f), raw), hn::Mul(ramp_t, hn::Sub(one, ramp_t))), k.alpha_min);
    out.alpha = hn::IfThenElse(on_ramp, hn::Mul(raw, ramp), out.alpha);
    out.slope = hn::IfThenElse(on_ramp, hn::Mul(raw, hn::Add(ramp, steep)), out.slope);
    out.slope = hn::IfThenElseZero(hn::Le(raw, k.alpha_max), out.slope);
  }
  return out;
}

/// alpha_at of engine/formulas/blending.h; fdx is fxx (pixel_x - x). `t` is the transmittance before and after; it is
/// negative where a pixel takes no more: then T (1 - alpha) < transmittance_min for any alpha.
template <bool kSmooth>
HWY_INLINE AlphaLanes alpha_lanes(const Splat& g, FloatVec fdx, FloatVec pixel_y, const AlphaConstants& k,
                                  FloatVec& t) {
  const FloatTag d;
  const FloatVec sign = hn::Set(d, -0.0f);
  const RawAlpha raw = raw_alpha<kSmooth>(g, fdx, pixel_y, k);
  const FloatVec next = hn::NegMulAdd(raw.alpha, t, t);
  AlphaLanes out;
  out.slope = raw.slope;
  out.taken = hn::And(raw.wanted, hn::Ge(next, k.transmittance_min));
  out.alpha = hn::IfThenElseZero(out.taken, raw.alpha);
  t = hn::IfThenElse(out.taken, next, hn::IfThenElse(raw.wanted, hn::Or(t, sign), t));
  return out;
}

/// The same bits when it is known which pixels are still open (BlendRecord::last).
template <bool kSmooth>
HWY_INLINE AlphaLanes alpha_lanes_within(const Splat& g, FloatVec fdx, FloatVec pixel_y, const AlphaConstants& k,
                                         FloatMask open, FloatVec& t) {
  const RawAlpha raw = raw_alpha<kSmooth>(g, fdx, pixel_y, k);
  AlphaLanes out;
  out.slope = raw.slope;
  out.taken = hn::And(raw.wanted, open);
  out.alpha = hn::IfThenElseZero(out.taken, raw.alpha);
  t = hn::NegMulAdd(out.alpha, t, t);
  return out;
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
