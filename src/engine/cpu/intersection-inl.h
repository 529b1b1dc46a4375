// Depth at which a pixel's ray meets a Gaussian's plane; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_
#undef ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_INTERSECTION_INL_H_
#endif

#include <hwy/highway.h>

#include "engine/cpu/splats.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// intersection_depth of engine/formulas/blending.h for a vector of rays (rx, ry, 1).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V intersection(D d, const Splat& g, V rx, V ry, V grazing) {
  const V s =
      hn::NegMulSub(hn::Set(d, g.normal[0]), rx, hn::MulAdd(hn::Set(d, g.normal[1]), ry, hn::Set(d, g.normal[2])));
  const V z = hn::Div(hn::Set(d, g.distance), s);
  const V bounded = hn::Min(hn::Max(z, hn::Set(d, g.z_min)), hn::Set(d, g.z_max));
  return hn::IfThenElse(hn::Lt(s, grazing), hn::Set(d, g.z), bounded);
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
