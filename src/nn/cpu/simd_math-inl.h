// Vector functions that the kernels share; compiled once per instruction set.
#if defined(ALIGNGS_NN_CPU_SIMD_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_NN_CPU_SIMD_MATH_INL_H_
#undef ALIGNGS_NN_CPU_SIMD_MATH_INL_H_
#else
#define ALIGNGS_NN_CPU_SIMD_MATH_INL_H_
#endif

#include <hwy/highway.h>

#include "core/simd_exp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs::nn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of at most 16 floats: the width of a panel (panels.h).
using FloatTag = HWY_CAPPED(float, 16);
using FloatVec = hn::Vec<FloatTag>;
inline constexpr size_t kLanes = hn::MaxLanes(FloatTag());

/// 2^x within 2 ulp for x in [-126, 127]; smaller x give 2^-126. Polynomial of degree 6 on [-1/2,
/// 1/2] (2e-9). Adding 1.5 * 2^23 rounds to an integer, which is then in the low bits.
HWY_INLINE FloatVec exp2_of(FloatVec x) {
  const FloatTag d;
  const hn::RebindToSigned<FloatTag> di;
  const FloatVec shift = hn::Set(d, 12582912.0f);
  x = hn::Max(x, hn::Set(d, -126.0f));
  const FloatVec shifted = hn::Add(x, shift);
  const FloatVec f = hn::Sub(x, hn::Sub(shifted, shift));
  FloatVec p = hn::MulAdd(hn::Set(d, 1.535336188e-4f), f, hn::Set(d, 1.339887440e-3f));
  p = hn::MulAdd(p, f, hn::Set(d, 9.618437357e-3f));
  p = hn::MulAdd(p, f, hn::Set(d, 5.550332548e-2f));
  p = hn::MulAdd(p, f, hn::Set(d, 2.402264791e-1f));
  p = hn::MulAdd(p, f, hn::Set(d, 6.931472028e-1f));
  p = hn::MulAdd(p, f, hn::Set(d, 1.0f));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

using aligngs::HWY_NAMESPACE::fast_exp;

/// erf(x) within 4e-7: quotient of polynomials of degrees 13 and 8 on [-4, 4] (the approximation
/// that Eigen and XLA use). At the ends erf is 1 to float accuracy.
HWY_INLINE FloatVec erf_of(FloatVec x) {
  const FloatTag d;
  x = hn::Min(hn::Max(x, hn::Set(d, -4.0f)), hn::Set(d, 4.0f));
  const FloatVec z = hn::Mul(x, x);
  FloatVec p = hn::MulAdd(hn::Set(d, -2.72614225801306e-10f), z, hn::Set(d, 2.77068142495902e-08f));
  p = hn::MulAdd(p, z, hn::Set(d, -2.10102402082508e-06f));
  p = hn::MulAdd(p, z, hn::Set(d, -5.69250639462346e-05f));
  p = hn::MulAdd(p, z, hn::Set(d, -7.34990630326855e-04f));
  p = hn::MulAdd(p, z, hn::Set(d, -2.95459980854025e-03f));
  p = hn::MulAdd(p, z, hn::Set(d, -1.60960333262415e-02f));
  FloatVec q = hn::MulAdd(hn::Set(d, -1.45660718464996e-05f), z, hn::Set(d, -2.13374055278905e-04f));
  q = hn::MulAdd(q, z, hn::Set(d, -1.68282697438203e-03f));
  q = hn::MulAdd(q, z, hn::Set(d, -7.37332916720468e-03f));
  q = hn::MulAdd(q, z, hn::Set(d, -1.42647390514189e-02f));
  return hn::Div(hn::Mul(x, p), q);
}

}  // namespace HWY_NAMESPACE
}  // namespace aligngs::nn
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
