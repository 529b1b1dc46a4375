#include "nn/cpu/row_kernels.h"

#include <algorithm>
#include <cmath>

#include "nn/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/cpu/row_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nn/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs::nn {
namespace HWY_NAMESPACE {

/// Calls body(i) for whole vectors and tail(i) for what is left of [0, n).
template <class Body, class Tail>
HWY_INLINE void over_lanes(int64_t n, Body&& body, Tail&& tail) {
  int64_t i = 0;
  for (; i + int64_t(kLanes) <= n; i += int64_t(kLanes)) body(i);
  if (i < n) tail(i, size_t(n - i));
}

HWY_INLINE FloatVec load_some(const float* x, size_t n) {
  HWY_ALIGN float lanes[kLanes] = {};
  for (size_t i = 0; i < n; ++i) lanes[i] = x[i];
  return hn::Load(FloatTag(), lanes);
}
HWY_INLINE void store_some(FloatVec v, size_t n, float* out) {
  HWY_ALIGN float lanes[kLanes];
  hn::Store(v, FloatTag(), lanes);
  for (size_t i = 0; i < n; ++i) out[i] = lanes[i];
}

void RoundToBfloat16(const float* x, int64_t count, bool relu, uint16_t* out) {
  const FloatTag d;
  const hn::RebindToUnsigned<FloatTag> du;
  const hn::Rebind<uint16_t, FloatTag> dh;
  const FloatVec floor = relu ? hn::Zero(d) : hn::Set(d, -3.4028235e38f);
  const auto rounded = [&](FloatVec v) {
    v = hn::Max(v, floor);
    const auto bits = hn::BitCast(du, v);
    const auto odd = hn::And(hn::ShiftRight<16>(bits), hn::Set(du, 1u));
    return hn::ShiftRight<16>(hn::Add(bits, hn::Add(odd, hn::Set(du, 0x7fffu))));
  };
  over_lanes(
      count,
      [&](int64_t i) {
        hn::StoreU(hn::DemoteTo(dh, hn::BitCast(hn::RebindToSigned<FloatTag>(), rounded(hn::LoadU(d, x + i)))), dh,
                   out + i);
      },
      [&](int64_t i, size_t n) {
        HWY_ALIGN uint32_t lanes[kLanes];
        hn::Store(rounded(load_some(x + i, n)), du, lanes);
        for (size_t k = 0; k < n; ++k) out[i + int64_t(k)] = uint16_t(lanes[k]);
      });
}

HWY_INLINE FloatVec gelu_of(FloatVec x) {
  const FloatTag d;
  const FloatVec half = hn::Mul(x, hn::Set(d, 0.5f));
  return hn::MulAdd(half, erf_of(hn::Mul(x, hn::Set(d, 0.70710678f))), half);
}
HWY_INLINE FloatVec silu_of(FloatVec x) {
  const FloatTag d;
  return hn::Div(x, hn::Add(hn::Set(d, 1.0f), fast_exp(d, hn::Min(hn::Neg(x), hn::Set(d, 87.0f)))));
}

template <class Function>
HWY_INLINE void activate_rows(float* y, int64_t rows, int64_t columns, const float* bias, Function&& function) {
  const FloatTag d;
  for (int64_t r = 0; r < rows; ++r, y += columns) {
    over_lanes(
        columns,
        [&](int64_t i) {
          const FloatVec v = hn::LoadU(d, y + i);
          hn::StoreU(function(bias ? hn::Add(v, hn::LoadU(d, bias + i)) : v), d, y + i);
        },
        [&](int64_t i, size_t n) {
          const FloatVec v = load_some(y + i, n);
          store_some(function(bias ? hn::Add(v, load_some(bias + i, n)) : v), n, y + i);
        });
  }
}

void AddBiasAndActivate(float* y, int64_t rows, int64_t columns, const float* bias, Activation activation) {
  switch (activation) {
    case Activation::kNone:
      if (bias) activate_rows(y, rows, columns, bias, [](FloatVec v) { return v; });
      return;
    case Activation::kRelu:
      return activate_rows(y, rows, columns, bias, [](FloatVec v) { return hn::Max(v, hn::Zero(FloatTag())); });
    case Activation::kGelu:
      return activate_rows(y, rows, columns, bias, [](FloatVec v) { return gelu_of(v); });
    case Activation::kSilu:
      return activate_rows(y, rows, columns, bias, [](FloatVec v) { return silu_of(v); });
  }
}

void Swiglu(const float* x, int64_t rows, int64_t columns, float* out) {
  const FloatTag d;
  for (int64_t r = 0; r < rows; ++r, x += 2 * columns, out += columns) {
    over_lanes(
        columns,
        [&](int64_t i) {
          const FloatVec gate = silu_of(hn::LoadU(d, x + i));
          hn::StoreU(hn::Mul(gate, hn::LoadU(d, x + columns + i)), d, out + i);
        },
        [&](int64_t i, size_t n) {
          const FloatVec gate = silu_of(load_some(x + i, n));
          store_some(hn::Mul(gate, load_some(x + columns + i, n)), n, out + i);
        });
  }
}

void AddScaled(float* x, const float* y, int64_t rows, int64_t columns, const float* bias, const float* scale) {
  const FloatTag d;
  const FloatVec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int64_t r = 0; r < rows; ++r, x += columns, y += columns) {
    over_lanes(
        columns,
        [&](int64_t i) {
          const FloatVec v = hn::Add(hn::LoadU(d, y + i), bias ? hn::LoadU(d, bias + i) : zero);
          const FloatVec s = scale ? hn::LoadU(d, scale + i) : one;
          hn::StoreU(hn::MulAdd(s, v, hn::LoadU(d, x + i)), d, x + i);
        },
        [&](int64_t i, size_t n) {
          const FloatVec v = hn::Add(load_some(y + i, n), bias ? load_some(bias + i, n) : zero);
          const FloatVec s = scale ? load_some(scale + i, n) : one;
          store_some(hn::MulAdd(s, v, load_some(x + i, n)), n, x + i);
        });
  }
}

void LayerNorm(const float* x, int64_t rows, int64_t columns, const float* weight, const float* bias, float eps,
               float* y) {
  const FloatTag d;
  for (int64_t r = 0; r < rows; ++r, x += columns, y += columns) {
    FloatVec sum = hn::Zero(d);
    over_lanes(
        columns, [&](int64_t i) { sum = hn::Add(sum, hn::LoadU(d, x + i)); },
        [&](int64_t i, size_t n) { sum = hn::Add(sum, load_some(x + i, n)); });
    const float mean = hn::GetLane(hn::SumOfLanes(d, sum)) / float(columns);
    FloatVec squares = hn::Zero(d);
    const FloatVec centre = hn::Set(d, mean);
    over_lanes(
        columns,
        [&](int64_t i) {
          const FloatVec v = hn::Sub(hn::LoadU(d, x + i), centre);
          squares = hn::MulAdd(v, v, squares);
        },
        [&](int64_t i, size_t n) {
          for (size_t k = 0; k < n; ++k) {
            HWY_ALIGN float one[kLanes] = {};
            one[0] = x[i + int64_t(k)] - mean;
            const FloatVec v = hn::Load(d, one);
            squares = hn::MulAdd(v, v, squares);
          }
        });
    const float variance = hn::GetLane(hn::SumOfLanes(d, squares)) / float(columns);
    const FloatVec scale = hn::Set(d, 1.0f / std::sqrt(variance + eps));
    over_lanes(
        columns,
        [&](int64_t i) {
          FloatVec v = hn::Mul(hn::Sub(hn::LoadU(d, x + i), centre), scale);
          if (weight) v = hn::MulAdd(v, hn::LoadU(d, weight + i), hn::LoadU(d, bias + i));
          hn::StoreU(v, d, y + i);
        },
        [&](int64_t i, size_t n) {
          FloatVec v = hn::Mul(hn::Sub(load_some(x + i, n), centre), scale);
          if (weight) v = hn::MulAdd(v, load_some(weight + i, n), load_some(bias + i, n));
          store_some(v, n, y + i);
        });
  }
}

void SoftmaxRows(float* x, int64_t rows, int64_t columns) {
  const FloatTag d;
  for (int64_t r = 0; r < rows; ++r, x += columns) {
    float most = x[0];
    for (int64_t i = 1; i < columns; ++i) most = std::max(most, x[i]);
    const FloatVec top = hn::Set(d, most);
    float total = 0;
    over_lanes(
        columns, [&](int64_t i) { hn::StoreU(fast_exp(d, hn::Sub(hn::LoadU(d, x + i), top)), d, x + i); },
        [&](int64_t i, size_t n) { store_some(fast_exp(d, hn::Sub(load_some(x + i, n), top)), n, x + i); });
    for (int64_t i = 0; i < columns; ++i) total += x[i];
    const float scale = 1.0f / total;
    for (int64_t i = 0; i < columns; ++i) x[i] *= scale;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace aligngs::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::nn {

HWY_EXPORT(RoundToBfloat16);
HWY_EXPORT(AddBiasAndActivate);
HWY_EXPORT(Swiglu);
HWY_EXPORT(AddScaled);
HWY_EXPORT(LayerNorm);
HWY_EXPORT(SoftmaxRows);

void round_to_bfloat16(const float* x, int64_t count, bool relu, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(RoundToBfloat16)(x, count, relu, out);
}
void relu_copy(const float* x, int64_t count, float* out) {
  for (int64_t i = 0; i < count; ++i) out[i] = std::max(x[i], 0.0f);
}
void add_bias_and_activate(float* y, int64_t rows, int64_t columns, const float* bias, Activation activation) {
  HWY_DYNAMIC_DISPATCH(AddBiasAndActivate)(y, rows, columns, bias, activation);
}
void swiglu(const float* x, int64_t rows, int64_t columns, float* out) {
  HWY_DYNAMIC_DISPATCH(Swiglu)(x, rows, columns, out);
}
void add_scaled(float* x, const float* y, int64_t rows, int64_t columns, const float* bias, const float* scale) {
  HWY_DYNAMIC_DISPATCH(AddScaled)(x, y, rows, columns, bias, scale);
}
void layer_norm(const float* x, int64_t rows, int64_t columns, const float* weight, const float* bias, float eps,
                float* y) {
  HWY_DYNAMIC_DISPATCH(LayerNorm)(x, rows, columns, weight, bias, eps, y);
}
void softmax_rows(float* x, int64_t rows, int64_t columns) { HWY_DYNAMIC_DISPATCH(SoftmaxRows)(x, rows, columns); }

}  // namespace aligngs::nn
#endif  // HWY_ONCE
