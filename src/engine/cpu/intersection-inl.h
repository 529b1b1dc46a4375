// Depth at which a pixel's ray meets a Gaussian's plane; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_
#undef ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_
#endif

#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"
#include "engine/cpu/splats.h"
#include "engine/formulas/blending.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Centres of the pixels of a block at (x, y) from pixel number `first` of the block on.
HWY_INLINE FloatVec pixel_centres_x(int x, size_t first) {
  HWY_ALIGN static constexpr float kColumn[kStripPixels] = {0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f,
                                                            0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f};
  const FloatTag d;
  return hn::Add(hn::LoadU(d, kColumn + first % kStripPixels), hn::Set(d, static_cast<float>(x)));
}
HWY_INLINE FloatVec pixel_centres_y(int y, size_t first) {
  HWY_ALIGN static constexpr float kRow[kStripPixels] = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f,
                                                         1.5f, 1.5f, 1.5f, 1.5f, 1.5f, 1.5f, 1.5f, 1.5f};
  const FloatTag d;
  const size_t row = first / kStripPixels * (kStripPixels / kBlockSize);
  return hn::Add(hn::LoadU(d, kRow + first % kStripPixels), hn::Set(d, static_cast<float>(y + static_cast<int>(row))));
}

/// Rays of pixels (z = 1) and 0.1 |ray|, below which the slope to a plane counts as grazing.
struct RayLanes {
  FloatVec x, y, grazing;
};
HWY_INLINE RayLanes ray_lanes(const ProjectionCamera<float>& camera, FloatVec pixel_x, FloatVec pixel_y) {
  const FloatTag d;
  const FloatVec x = hn::Div(hn::Sub(pixel_x, hn::Set(d, camera.cx)), hn::Set(d, camera.fx));
  const FloatVec y = hn::Div(hn::Sub(pixel_y, hn::Set(d, camera.cy)), hn::Set(d, camera.fy));
  const FloatVec length = hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Set(d, 1.0f))));
  return {x, y, hn::Mul(hn::Set(d, float(kGrazingCosine)), length)};
}

/// intersection_depth of engine/formulas/blending.h for a vector of rays (rx, ry, 1).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V intersection(D d, const Splat& g, V rx, V ry, V grazing) {
  const V s =
      hn::NegMulSub(hn::Set(d, g.normal[0]), rx, hn::MulAdd(hn::Set(d, g.normal[1]), ry, hn::Set(d, g.normal[2])));
  const V z = hn::Mul(hn::Set(d, g.distance), fast_reciprocal(d, s));
  const V bounded = hn::Min(hn::Max(z, hn::Set(d, g.z_min)), hn::Set(d, g.z_max));
  return hn::IfThenElse(hn::Lt(s, grazing), hn::Set(d, g.z), bounded);
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
