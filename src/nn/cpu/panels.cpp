#include "nn/cpu/panels.h"

#include "nn/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nn/cpu/panels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nn/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs::nn {
namespace HWY_NAMESPACE {

constexpr size_t kVectors = size_t(kPanel) / kLanes;  // per row of a panel
// Register tiles: kTile x kVectors accumulators, of 32 registers with AVX-512 and 16 otherwise.
constexpr size_t kTile = kVectors == 1 ? 12 : kVectors == 2 ? 6 : kVectors == 4 ? 2 : 1;

template <size_t kRows>
HWY_INLINE void multiply_tile(const PanelProduct& p, int64_t row) {
  const FloatTag d;
  FloatVec sum[kRows][kVectors];
  float* c = p.c + row * p.c_stride;
  for (size_t m = 0; m < kRows; ++m) {
    for (size_t v = 0; v < kVectors; ++v) {
      sum[m][v] = p.accumulate ? hn::LoadU(d, c + int64_t(m) * p.c_stride + int64_t(v * kLanes)) : hn::Zero(d);
    }
  }
  const float* a = p.a + row * p.a_stride;
  const float* b = p.b;
  for (int64_t k = 0; k < p.depth; ++k, b += kPanel) {
    FloatVec column[kVectors];
    for (size_t v = 0; v < kVectors; ++v) column[v] = hn::LoadU(d, b + v * kLanes);
    for (size_t m = 0; m < kRows; ++m) {
      const FloatVec x = hn::Set(d, a[int64_t(m) * p.a_stride + k]);
      for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::MulAdd(x, column[v], sum[m][v]);
    }
  }
  for (size_t m = 0; m < kRows; ++m) {
    for (size_t v = 0; v < kVectors; ++v) {
      hn::StoreU(sum[m][v], d, c + int64_t(m) * p.c_stride + int64_t(v * kLanes));
    }
  }
}

void MultiplyPanel(const PanelProduct& p) {
  int64_t row = 0;
  for (; row + int64_t(kTile) <= p.rows; row += int64_t(kTile)) multiply_tile<kTile>(p, row);
  if constexpr (kTile > 4) {
    for (; row + 4 <= p.rows; row += 4) multiply_tile<4>(p, row);
  }
  for (; row < p.rows; ++row) multiply_tile<1>(p, row);
}

void Step(const SoftmaxStep& s) {
  const FloatTag d;
  for (size_t v = 0; v < kVectors; ++v) {
    const size_t lane = v * kLanes;
    FloatVec most = hn::LoadU(d, s.most + lane);
    const FloatVec before = most;
    for (int64_t k = 0; k < s.keys; ++k) most = hn::Max(most, hn::LoadU(d, s.scores + k * kPanel + lane));
    FloatVec total = hn::Zero(d);
    for (int64_t k = 0; k < s.keys; ++k) {
      float* score = s.scores + k * kPanel + lane;
      const FloatVec weight = exp2_of(hn::Sub(hn::LoadU(d, score), most));
      total = hn::Add(total, weight);
      hn::StoreU(weight, d, score);
    }
    const FloatVec change = exp2_of(hn::Sub(before, most));
    hn::StoreU(most, d, s.most + lane);
    hn::StoreU(hn::MulAdd(hn::LoadU(d, s.total + lane), change, total), d, s.total + lane);
    for (int64_t i = 0; i < s.dimensions; ++i) {
      float* sum = s.sums + i * kPanel + lane;
      hn::StoreU(hn::Mul(hn::LoadU(d, sum), change), d, sum);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace aligngs::nn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::nn {

HWY_EXPORT(MultiplyPanel);
HWY_EXPORT(Step);

void multiply_panel(const PanelProduct& product) { HWY_DYNAMIC_DISPATCH(MultiplyPanel)(product); }
void softmax_step(const SoftmaxStep& step) { HWY_DYNAMIC_DISPATCH(Step)(step); }

}  // namespace aligngs::nn
#endif  // HWY_ONCE
