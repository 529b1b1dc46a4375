// The boxes of pixels that a Gaussian can reach; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_OVERLAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_OVERLAP_INL_H_
#undef ALIGNGS_ENGINE_CPU_OVERLAP_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_OVERLAP_INL_H_
#endif

#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"
#include "engine/cpu/splats.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A vector of Gaussians.
struct OverlapLanes {
  FloatVec x, y, fxx, fxy, fyy, level;
  FloatVec along_x, along_y;  ///< slopes of the lines on which p^2 + r^2 is least for a given dy, a given dx
};

/// Lanes from `count` on repeat the last Gaussian.
HWY_INLINE OverlapLanes overlap_lanes(const Splat* splats, size_t count) {
  // Slack of the test, relative and absolute: it only bounds the work, the alpha test decides.
  constexpr float kLevelFactor = 1.001f, kLevelMargin = 1e-3f;
  const FloatTag d;
  HWY_ALIGN float fields[6][kLanes];
  for (size_t i = 0; i < kLanes; ++i) {
    const Splat& s = splats[HWY_MIN(i, count - 1)];
    fields[0][i] = s.x;
    fields[1][i] = s.y;
    fields[2][i] = s.fxx;
    fields[3][i] = s.fxy;
    fields[4][i] = s.fyy;
    fields[5][i] = s.level;
  }
  OverlapLanes o{hn::Load(d, fields[0]),
                 hn::Load(d, fields[1]),
                 hn::Load(d, fields[2]),
                 hn::Load(d, fields[3]),
                 hn::Load(d, fields[4]),
                 hn::Zero(d),
                 hn::Zero(d),
                 hn::Zero(d)};
  o.level = hn::MulAdd(hn::Load(d, fields[5]), hn::Set(d, kLevelFactor), hn::Set(d, kLevelMargin));
  o.along_y = hn::Neg(hn::Div(hn::Mul(o.fxx, o.fxy), hn::MulAdd(o.fxy, o.fxy, hn::Mul(o.fyy, o.fyy))));
  o.along_x = hn::Neg(hn::Div(o.fxy, o.fxx));
  return o;
}

/// Columns [left, left + width) of pixels, or rows, as far as they do not depend on each other.
struct BoxColumns {
  FloatVec x0, x1, ex;  ///< relative to the mean; ex is nearest to it
  FloatVec vy;          ///< the least p^2 + r^2 at ex lies here
};
struct BoxRows {
  FloatVec y0, y1;
  FloatVec hx;             ///< the least p^2 + r^2 at the nearest row lies here
  FloatVec fxy_ey, hr_hr;  ///< products of that row
};
HWY_INLINE BoxColumns box_columns(const OverlapLanes& o, float left, float width) {
  const FloatTag d;
  BoxColumns c;
  c.x0 = hn::Sub(hn::Set(d, left + 0.5f), o.x);
  c.x1 = hn::Add(c.x0, hn::Set(d, width - 1));
  c.ex = hn::Min(hn::Max(hn::Zero(d), c.x0), c.x1);
  c.vy = hn::Mul(c.ex, o.along_y);
  return c;
}
HWY_INLINE BoxRows box_rows(const OverlapLanes& o, float top, float height) {
  const FloatTag d;
  BoxRows r;
  r.y0 = hn::Sub(hn::Set(d, top + 0.5f), o.y);
  r.y1 = hn::Add(r.y0, hn::Set(d, height - 1));
  const FloatVec ey = hn::Min(hn::Max(hn::Zero(d), r.y0), r.y1);
  r.hx = hn::Mul(ey, o.along_x);
  r.fxy_ey = hn::Mul(o.fxy, ey);
  const FloatVec hr = hn::Mul(o.fyy, ey);
  r.hr_hr = hn::Mul(hr, hr);
  return r;
}

/// True where alpha_min can be reached at a pixel centre of the columns and rows. The form p^2 + r^2 is convex, so over a
/// box that does not hold the mean its minimum lies on the nearest vertical or horizontal edge.
HWY_INLINE hn::Mask<FloatTag> reaches_box(const OverlapLanes& o, const BoxColumns& c, const BoxRows& r) {
  const FloatVec vy = hn::Min(hn::Max(c.vy, r.y0), r.y1), hx = hn::Min(hn::Max(r.hx, c.x0), c.x1);
  const FloatVec vp = hn::MulAdd(o.fxx, c.ex, hn::Mul(o.fxy, vy)), vr = hn::Mul(o.fyy, vy);
  const FloatVec hp = hn::MulAdd(o.fxx, hx, r.fxy_ey);
  const FloatVec vertical = hn::MulAdd(vp, vp, hn::Mul(vr, vr)), horizontal = hn::MulAdd(hp, hp, r.hr_hr);
  return hn::Le(hn::Min(vertical, horizontal), o.level);
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
