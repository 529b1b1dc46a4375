#include "engine/cpu/adam.h"

#include <cstring>

#include "engine/cpu/simd_targets.h"
#include "engine/cpu/tile_products.h"
#include "gaussians/gaussian_model.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/adam.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Constants of a step, one per lane.
struct Constants {
  FloatVec beta1, beta2, keep1, keep2, correction, epsilon;
};
HWY_INLINE Constants make_constants(const AdamStep<float>& a) {
  const FloatTag d;
  return {hn::Set(d, a.beta1),
          hn::Set(d, a.beta2),
          hn::Set(d, 1.0f - a.beta1),
          hn::Set(d, 1.0f - a.beta2),
          hn::Set(d, a.second_correction),
          hn::Set(d, a.epsilon)};
}

HWY_INLINE void update(const Constants& k, FloatVec step_size, FloatVec g, float* p, float* m, float* v) {
  const FloatTag d;
  const FloatVec first = hn::MulAdd(k.beta1, hn::LoadU(d, m), hn::Mul(k.keep1, g));
  const FloatVec second = hn::MulAdd(k.beta2, hn::LoadU(d, v), hn::Mul(hn::Mul(k.keep2, g), g));
  const FloatVec change = hn::Div(hn::Mul(step_size, first), hn::MulAdd(hn::Sqrt(second), k.correction, k.epsilon));
  hn::StoreU(first, d, m);
  hn::StoreU(second, d, v);
  hn::StoreU(hn::Sub(hn::LoadU(d, p), change), d, p);
}

/// The last n < kLanes numbers, so that no neighbour is touched.
HWY_INLINE void update_tail(const Constants& k, FloatVec step_size, FloatVec g, size_t n, float* p, float* m,
                            float* v) {
#if HWY_MEM_OPS_MIGHT_FAULT
  float tail[3][kLanes] = {};
  const size_t bytes = n * sizeof(float);
  std::memcpy(tail[0], p, bytes);
  std::memcpy(tail[1], m, bytes);
  std::memcpy(tail[2], v, bytes);
  update(k, step_size, g, tail[0], tail[1], tail[2]);
  std::memcpy(p, tail[0], bytes);
  std::memcpy(m, tail[1], bytes);
  std::memcpy(v, tail[2], bytes);
#else
  const FloatTag d;
  const auto here = hn::FirstN(d, n);
  const FloatVec first = hn::MulAdd(k.beta1, hn::MaskedLoad(here, d, m), hn::Mul(k.keep1, g));
  const FloatVec second = hn::MulAdd(k.beta2, hn::MaskedLoad(here, d, v), hn::Mul(hn::Mul(k.keep2, g), g));
  const FloatVec change = hn::Div(hn::Mul(step_size, first), hn::MulAdd(hn::Sqrt(second), k.correction, k.epsilon));
  hn::BlendedStore(first, here, d, m);
  hn::BlendedStore(second, here, d, v);
  hn::BlendedStore(hn::Sub(hn::MaskedLoad(here, d, p), change), here, d, p);
#endif
}

bool AllWithin(const float* values, size_t count, float limit) {
  const FloatTag d;
  const FloatVec bound = hn::Set(d, limit);
  size_t i = 0;
  auto good = hn::Eq(bound, bound);
  for (; i + kLanes <= count; i += kLanes) good = hn::And(good, hn::Le(hn::Abs(hn::LoadU(d, values + i)), bound));
  if (!hn::AllTrue(d, good)) return false;
  for (; i < count; ++i) {
    if (!(values[i] <= limit && values[i] >= -limit)) return false;
  }
  return true;
}

void AdamRange(const AdamStep<float>& step, const float* gradients, size_t count, float* parameters, float* m,
               float* v) {
  const FloatTag d;
  const Constants k = make_constants(step);
  const FloatVec step_size = hn::Set(d, step.step_size);
  size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    update(k, step_size, hn::LoadU(d, gradients + i), parameters + i, m + i, v + i);
  }
  if (i < count) {
    float tail[kLanes] = {};
    std::memcpy(tail, gradients + i, (count - i) * sizeof(float));
    update_tail(k, step_size, hn::LoadU(d, tail), count - i, parameters + i, m + i, v + i);
  }
}

void AdamShRows(const ShAdam& steps, const float* gradients, const unsigned char* touched, size_t rows,
                float* parameters, float* m, float* v) {
  constexpr size_t kRow = 3 * kShCoefficients;
  const FloatTag d;
  const Constants k = make_constants(steps.rest);
  HWY_ALIGN float step_sizes[kRow];
  for (size_t i = 0; i < kRow; ++i) step_sizes[i] = i < 3 ? steps.dc.step_size : steps.rest.step_size;
  const size_t used = HWY_MIN(kRow, (steps.used + 15) / 16 * 16);
  const FloatVec zero = hn::Zero(d);
  for (size_t row = 0; row < rows; ++row) {
    const size_t base = row * kRow;
    for (size_t i = 0; i < used; i += kLanes) {
      const FloatVec g = touched[row] != 0 ? hn::LoadU(d, gradients + base + i) : zero;
      update(k, hn::Load(d, step_sizes + i), g, parameters + base + i, m + base + i, v + base + i);
    }
  }
}

HWY_INLINE FloatVec load_numbers(const float* p) { return hn::Load(FloatTag(), p); }
/// bfloat16: the upper half of a float.
HWY_INLINE FloatVec load_numbers(const uint16_t* p) {
  const FloatTag d;
  const hn::RebindToUnsigned<FloatTag> du;
  const hn::Rebind<uint16_t, FloatTag> dh;
  return hn::BitCast(d, hn::ShiftLeft<16>(hn::PromoteTo(du, hn::LoadU(dh, p))));
}

template <class Number>
void adam_row(const AdamStep<float>& step, const float* gradient, const Number* softmax, size_t channels,
              float* parameters, float* m, float* v) {
  const FloatTag d;
  const Constants k = make_constants(step);
  const FloatVec step_size = hn::Set(d, step.step_size), zero = hn::Zero(d);
  FloatVec along = zero;
  if (gradient != nullptr && softmax != nullptr) {  // both are zero-padded to whole vectors
    for (size_t c = 0; c < channels; c += kLanes) {
      along = hn::MulAdd(load_numbers(softmax + c), hn::Load(d, gradient + c), along);
    }
    along = hn::SumOfLanes(d, along);
  }
  for (size_t c = 0; c < channels; c += kLanes) {
    FloatVec g = gradient != nullptr ? hn::Load(d, gradient + c) : zero;
    if (softmax != nullptr) g = hn::Mul(load_numbers(softmax + c), hn::Sub(g, along));
    if (c + kLanes <= channels) {
      update(k, step_size, g, parameters + c, m + c, v + c);
    } else {
      update_tail(k, step_size, g, channels - c, parameters + c, m + c, v + c);
    }
  }
}

void AdamSemanticRow(const AdamStep<float>& step, const float* gradient, const float* softmax, size_t channels,
                     float* parameters, float* m, float* v) {
  adam_row(step, gradient, softmax, channels, parameters, m, v);
}
void AdamRoundedRow(const AdamStep<float>& step, const float* gradient, const uint16_t* softmax, size_t channels,
                    float* parameters, float* m, float* v) {
  adam_row(step, gradient, softmax, channels, parameters, m, v);
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(AllWithin);
HWY_EXPORT(AdamRange);
HWY_EXPORT(AdamShRows);
HWY_EXPORT(AdamSemanticRow);
HWY_EXPORT(AdamRoundedRow);

bool all_within(const float* values, size_t count, float limit) {
  return HWY_DYNAMIC_DISPATCH(AllWithin)(values, count, limit);
}
void adam_range(const AdamStep<float>& step, const float* gradients, size_t count, float* parameters, float* m,
                float* v) {
  HWY_DYNAMIC_DISPATCH(AdamRange)(step, gradients, count, parameters, m, v);
}
void adam_sh_rows(const ShAdam& steps, const float* gradients, const unsigned char* touched, size_t rows,
                  float* parameters, float* m, float* v) {
  HWY_DYNAMIC_DISPATCH(AdamShRows)(steps, gradients, touched, rows, parameters, m, v);
}
void adam_semantic_row(const AdamStep<float>& step, const float* gradient, const float* softmax, size_t channels,
                       float* parameters, float* m, float* v) {
  HWY_DYNAMIC_DISPATCH(AdamSemanticRow)(step, gradient, softmax, channels, parameters, m, v);
}
void adam_semantic_row(const AdamStep<float>& step, const float* gradient, const uint16_t* softmax, size_t channels,
                       float* parameters, float* m, float* v) {
  HWY_DYNAMIC_DISPATCH(AdamRoundedRow)(step, gradient, softmax, channels, parameters, m, v);
}

}  // namespace aligngs::cpu
#endif
