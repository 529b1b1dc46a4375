// Vector functions that the kernels share; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_
#undef ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_
#endif

#include <hwy/highway.h>

#include "core/simd_exp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of at most 16 floats: a strip of 8 x 2 pixels.
using FloatTag = HWY_CAPPED(float, 16);
using FloatVec = hn::Vec<FloatTag>;
inline constexpr size_t kLanes = hn::MaxLanes(FloatTag());

using aligngs::HWY_NAMESPACE::fast_exp;

/// 2^x within 2.5 ulp for x in [-126, 127]; smaller x give 2^-126. Minimax polynomial of degree 5 on [-1/2, 1/2]
/// (9e-8), exact at 0. Adding 1.5 * 2^23 rounds to an integer, which is then in the low bits.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fast_exp2(D d, V x) {
  const hn::RebindToSigned<D> di;
  const V shift = hn::Set(d, 12582912.0f);
  x = hn::Max(x, hn::Set(d, -126.0f));
  const V shifted = hn::Add(x, shift);
  const V f = hn::Sub(x, hn::Sub(shifted, shift));
  V p = hn::MulAdd(hn::Set(d, 1.326472696e-3f), f, hn::Set(d, 9.671512668e-3f));
  p = hn::MulAdd(p, f, hn::Set(d, 5.550733744e-2f));
  p = hn::MulAdd(p, f, hn::Set(d, 2.402224208e-1f));
  p = hn::MulAdd(p, f, hn::Set(d, 6.931469776e-1f));
  p = hn::MulAdd(p, f, hn::Set(d, 1.0f));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

/// 1 / x within 3.5 ulp for normal x whose reciprocal is normal (3 with multiply-adds): Newton steps from an estimate,
/// which leave the divider to nobody. On x86 the estimate has 11.5 bits or more and one step suffices.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fast_reciprocal(D d, V x) {
  const V two = hn::Set(d, 2.0f);
  V y = hn::ApproximateReciprocal(x);
#if !HWY_ARCH_X86
  y = hn::Mul(y, hn::NegMulAdd(x, y, two));
#endif
  return hn::Mul(y, hn::NegMulAdd(x, y, two));
}

/// log(x) within 2 ulp for normal positive x. Polynomial of Cephes' logf.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fast_log(D d, V x) {
  const hn::RebindToSigned<D> di;
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)).
  const auto bits = hn::BitCast(di, x);
  auto e = hn::Sub(hn::ShiftRight<23>(bits), hn::Set(di, 126));
  V m = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(di, 0x007fffff)), hn::Set(di, 0x3f000000)));
  const auto low = hn::Lt(m, hn::Set(d, 0.707106781f));
  V ef = hn::ConvertTo(d, e);
  ef = hn::Sub(ef, hn::IfThenElseZero(low, hn::Set(d, 1.0f)));
  m = hn::Sub(hn::Add(m, hn::IfThenElseZero(low, m)), hn::Set(d, 1.0f));
  V p = hn::MulAdd(hn::Set(d, 7.0376836292e-2f), m, hn::Set(d, -1.1514610310e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, 1.1676998740e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, -1.2420140846e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, 1.4249322787e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, -1.6668057665e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, 2.0000714765e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, -2.4999993993e-1f));
  p = hn::MulAdd(p, m, hn::Set(d, 3.3333331174e-1f));
  const V z = hn::Mul(m, m);
  V y = hn::Mul(hn::Mul(p, m), z);
  y = hn::MulAdd(ef, hn::Set(d, -2.12194440e-4f), y);
  y = hn::NegMulAdd(hn::Set(d, 0.5f), z, y);
  return hn::MulAdd(ef, hn::Set(d, 0.693359375f), hn::Add(m, y));
}

/// Natural logarithm within 5e-7 max(1, |log x|) for normal positive x: enough for values of a loss. Chebyshev series
/// of degree 6 of log(m) / (m - 1) for m in [sqrt(1/2), sqrt(2)).
HWY_INLINE FloatVec loss_log(FloatVec x) {
  const FloatTag d;
  const hn::RebindToSigned<FloatTag> di;
  const auto bits = hn::BitCast(di, x);
  const auto e = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(di, 0x3f3504f3)));
  const FloatVec z = hn::Sub(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(e))), hn::Set(d, 1.0f));
  FloatVec p = hn::MulAdd(hn::Set(d, 0.119310543f), z, hn::Set(d, -0.186807513f));
  p = hn::MulAdd(p, z, hn::Set(d, 0.204917595f));
  p = hn::MulAdd(p, z, hn::Set(d, -0.249082893f));
  p = hn::MulAdd(p, z, hn::Set(d, 0.333146751f));
  p = hn::MulAdd(p, z, hn::Set(d, -0.500011444f));
  p = hn::MulAdd(p, z, hn::Set(d, 1.00000095f));
  return hn::MulAdd(p, z, hn::Mul(hn::ConvertTo(d, e), hn::Set(d, 0.693147181f)));
}

/// log2(x) within 1.5e-5 for x in [2^-20, 4), within 2.5e-5 for any normal positive x. Exponent and mantissa together
/// are a number that is linear in the mantissa m. The minimax polynomial of degree 5 of log2(m) - (m - 1) for m in [1,
/// 2) adds the rest.
HWY_INLINE FloatVec rough_log2(FloatVec x) {
  const FloatTag d;
  const hn::RebindToSigned<FloatTag> di;
  const auto bits = hn::BitCast(di, x);
  const FloatVec linear = hn::ConvertTo(d, hn::Sub(bits, hn::Set(di, 0x3f800000)));
  const FloatVec m = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(di, 0x007fffff)), hn::Set(di, 0x3f800000)));
  FloatVec p = hn::MulAdd(hn::Set(d, 0.0448736103f), m, hn::Set(d, -0.416563687f));
  p = hn::MulAdd(p, m, hn::Set(d, 1.63114877f));
  p = hn::MulAdd(p, m, hn::Set(d, -3.55079293f));
  p = hn::MulAdd(p, m, hn::Set(d, 4.09171081f));
  p = hn::MulAdd(p, m, hn::Set(d, -1.80036404f));
  return hn::MulAdd(linear, hn::Set(d, 1.1920929e-7f), p);  // 2^-23
}

#if HWY_TARGET != HWY_SCALAR
/// In each block of four lanes: what the block adds to the lane sums of [a, b, c, e].
template <class D, class V = hn::Vec<D>>
HWY_INLINE V block_sums(D d, V a, V b, V c, V e) {
  const V ab = hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  const V ce = hn::Add(hn::InterleaveLower(d, c, e), hn::InterleaveUpper(d, c, e));
  const hn::Repartition<double, D> dd;
  const auto lower = hn::InterleaveLower(dd, hn::BitCast(dd, ab), hn::BitCast(dd, ce));
  const auto upper = hn::InterleaveUpper(dd, hn::BitCast(dd, ab), hn::BitCast(dd, ce));
  return hn::Add(hn::BitCast(d, lower), hn::BitCast(d, upper));
}
#endif

/// out[0..16) = lane sums of v[0..16); `out` on a cache line.
HWY_INLINE void store_lane_sums(const FloatVec* v, float* HWY_RESTRICT out) {
  [[maybe_unused]] const FloatTag d;  // not used with one lane
#if HWY_TARGET == HWY_SCALAR
  for (int i = 0; i < 16; ++i) out[i] = hn::GetLane(v[i]);
#else
  const FloatVec s0 = block_sums(d, v[0], v[1], v[2], v[3]), s1 = block_sums(d, v[4], v[5], v[6], v[7]);
  const FloatVec s2 = block_sums(d, v[8], v[9], v[10], v[11]), s3 = block_sums(d, v[12], v[13], v[14], v[15]);
#if HWY_MAX_BYTES >= 64
  // Blocks of x: [A0 B0 A2 B2], of y: [A1 B1 A3 B3]; wanted: [A0 + B0, A1 + B1, A2 + B2, A3 + B3].
  const FloatVec x = hn::Add(hn::ConcatLowerLower(d, s2, s0), hn::ConcatUpperUpper(d, s2, s0));
  const FloatVec y = hn::Add(hn::ConcatLowerLower(d, s3, s1), hn::ConcatUpperUpper(d, s3, s1));
  const FloatVec straight = hn::OddEvenBlocks(y, x), crossed = hn::SwapAdjacentBlocks(hn::OddEvenBlocks(x, y));
  hn::Store(hn::Add(straight, crossed), d, out);
#elif HWY_MAX_BYTES >= 32
  hn::Store(hn::Add(hn::ConcatLowerLower(d, s1, s0), hn::ConcatUpperUpper(d, s1, s0)), d, out);
  hn::Store(hn::Add(hn::ConcatLowerLower(d, s3, s2), hn::ConcatUpperUpper(d, s3, s2)), d, out + 8);
#else
  hn::Store(s0, d, out);
  hn::Store(s1, d, out + 4);
  hn::Store(s2, d, out + 8);
  hn::Store(s3, d, out + 12);
#endif
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
