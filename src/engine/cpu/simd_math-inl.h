// Vector functions that the kernels share; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_
#undef ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_SIMD_MATH_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of at most 16 floats: a strip of 8 x 2 pixels.
using FloatTag = HWY_CAPPED(float, 16);
using FloatVec = hn::Vec<FloatTag>;
inline constexpr size_t kLanes = hn::MaxLanes(FloatTag());

/// exp(x) within 2 ulp for x in [-87, 88]; smaller x give exp(-87) = 1.6e-38. Polynomial of Cephes' expf.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fast_exp(D d, V x) {
  const hn::RebindToSigned<D> di;
  x = hn::Max(x, hn::Set(d, -87.0f));
  const V n = hn::Round(hn::Mul(x, hn::Set(d, 1.44269504f)));
  V r = hn::NegMulAdd(n, hn::Set(d, 0.693359375f), x);
  r = hn::NegMulAdd(n, hn::Set(d, -2.12194440e-4f), r);
  V p = hn::MulAdd(hn::Set(d, 1.9875691500e-4f), r, hn::Set(d, 1.3981999507e-3f));
  p = hn::MulAdd(p, r, hn::Set(d, 8.3334519073e-3f));
  p = hn::MulAdd(p, r, hn::Set(d, 4.1665795894e-2f));
  p = hn::MulAdd(p, r, hn::Set(d, 1.6666665459e-1f));
  p = hn::MulAdd(p, r, hn::Set(d, 5.0000001201e-1f));
  p = hn::MulAdd(p, hn::Mul(r, r), hn::Add(r, hn::Set(d, 1.0f)));
  const auto exponent = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, n), hn::Set(di, 127)));
  return hn::Mul(p, hn::BitCast(d, exponent));
}

/// 2^x within 2 ulp for x in [-126, 127]; smaller x give 2^-126. Polynomial of degree 6 on [-1/2, 1/2] (2e-9). Adding
/// 1.5 * 2^23 rounds to an integer, which then stands in the low bits.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fast_exp2(D d, V x) {
  const hn::RebindToSigned<D> di;
  const V shift = hn::Set(d, 12582912.0f);
  x = hn::Max(x, hn::Set(d, -126.0f));
  const V shifted = hn::Add(x, shift);
  const V f = hn::Sub(x, hn::Sub(shifted, shift));
  V p = hn::MulAdd(hn::Set(d, 1.535336188e-4f), f, hn::Set(d, 1.339887440e-3f));
  p = hn::MulAdd(p, f, hn::Set(d, 9.618437357e-3f));
  p = hn::MulAdd(p, f, hn::Set(d, 5.550332548e-2f));
  p = hn::MulAdd(p, f, hn::Set(d, 2.402264791e-1f));
  p = hn::MulAdd(p, f, hn::Set(d, 6.931472028e-1f));
  p = hn::MulAdd(p, f, hn::Set(d, 1.0f));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

/// 1 / x within 2 ulp for normal x whose reciprocal is normal: Newton steps from an estimate of 11 bits or more, which
/// leave the divider to nobody.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V fast_reciprocal(D d, V x) {
  const V two = hn::Set(d, 2.0f);
  V y = hn::ApproximateReciprocal(x);
  y = hn::Mul(y, hn::NegMulAdd(x, y, two));
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

/// Adds the lane sums of a, b, c, e to out[0..3].
template <class D, class V = hn::Vec<D>>
HWY_INLINE void add_lane_sums(D d, V a, V b, V c, V e, float* HWY_RESTRICT out) {
#if HWY_TARGET == HWY_SCALAR
  out[0] += hn::GetLane(a);
  out[1] += hn::GetLane(b);
  out[2] += hn::GetLane(c);
  out[3] += hn::GetLane(e);
#else
  // Within each block of four lanes: [a0+a2, b0+b2, a1+a3, b1+b3], then [a, b, c, e].
  const V ab = hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  const V ce = hn::Add(hn::InterleaveLower(d, c, e), hn::InterleaveUpper(d, c, e));
  const hn::Repartition<double, D> dd;
  const auto lower = hn::InterleaveLower(dd, hn::BitCast(dd, ab), hn::BitCast(dd, ce));
  const auto upper = hn::InterleaveUpper(dd, hn::BitCast(dd, ab), hn::BitCast(dd, ce));
  const V sums = hn::Add(hn::BitCast(d, lower), hn::BitCast(d, upper));
  const HWY_CAPPED(float, 4) d4;
#if HWY_MAX_BYTES >= 64
  const HWY_CAPPED(float, 8) d8;
  const auto half = hn::Add(hn::LowerHalf(d8, sums), hn::UpperHalf(d8, sums));
  const auto block = hn::Add(hn::LowerHalf(d4, half), hn::UpperHalf(d4, half));
#elif HWY_MAX_BYTES >= 32
  const auto block = hn::Add(hn::LowerHalf(d4, sums), hn::UpperHalf(d4, sums));
#else
  const auto block = sums;
#endif
  hn::StoreU(hn::Add(hn::LoadU(d4, out), block), d4, out);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
