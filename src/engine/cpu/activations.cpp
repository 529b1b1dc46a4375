#include "engine/cpu/activations.h"

#include <cstring>
#include <limits>

#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/activations.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Calls f for whole vectors; the last one through a buffer, so that no neighbour is touched.
template <class F>
void map_range(const float* in, size_t count, float* out, const F& f) {
  const FloatTag d;
  size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) hn::StoreU(f(hn::LoadU(d, in + i)), d, out + i);
  if (i == count) return;
  HWY_ALIGN float tail[kLanes] = {};
  std::memcpy(tail, in + i, (count - i) * sizeof(float));
  hn::Store(f(hn::Load(d, tail)), d, tail);
  std::memcpy(out + i, tail, (count - i) * sizeof(float));
}

constexpr float kLargestLog = 88.0f;  ///< fast_exp stays finite up to here

void ExpRange(const float* logs, size_t count, float* out) {
  map_range(logs, count, out, [](FloatVec x) HWY_ATTR {
    const FloatTag d;
    const FloatVec top = hn::Set(d, kLargestLog), infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    return hn::IfThenElse(hn::Gt(x, top), infinity, fast_exp(d, hn::Min(x, top)));
  });
}

void SigmoidRange(const float* logits, size_t count, float* out) {
  map_range(logits, count, out, [](FloatVec x) HWY_ATTR {
    const FloatTag d;
    const FloatVec one = hn::Set(d, 1.0f);
    return hn::Div(one, hn::Add(one, fast_exp(d, hn::Min(hn::Neg(x), hn::Set(d, kLargestLog)))));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(ExpRange);
HWY_EXPORT(SigmoidRange);

void exp_range(const float* logs, size_t count, float* out) { HWY_DYNAMIC_DISPATCH(ExpRange)(logs, count, out); }
void sigmoid_range(const float* logits, size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(SigmoidRange)(logits, count, out);
}

}  // namespace aligngs::cpu
#endif
