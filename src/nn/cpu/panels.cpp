#include "nn/cpu/panels.h"

#include "core/half.h"
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
// Register tiles: kTile rows of kJoined panels, of 32 registers with AVX-512 and 16 otherwise. Each number of a row is
// used for all vectors of the tile, so that loads are fewer than multiplications.
constexpr size_t kJoined = kVectors == 1 ? size_t(kJoinedPanels) : 1;
constexpr size_t kTile = kVectors == 1 ? 8 : kVectors == 2 ? 6 : kVectors == 4 ? 2 : 1;

template <size_t kRows, size_t kPanels>
HWY_INLINE void multiply_tile(const PanelProduct& p, const float* b, float* c, int64_t row) {
  const FloatTag d;
  FloatVec sum[kRows][kPanels][kVectors];
  for (size_t m = 0; m < kRows; ++m) {
    for (size_t n = 0; n < kPanels; ++n) {
      for (size_t v = 0; v < kVectors; ++v) sum[m][n][v] = hn::Zero(d);
    }
  }
  const float* a = p.a + row * p.a_stride;
  for (int64_t k = 0; k < p.depth; ++k, b += kPanel) {
    FloatVec column[kPanels][kVectors];
    for (size_t n = 0; n < kPanels; ++n) {
      for (size_t v = 0; v < kVectors; ++v) column[n][v] = hn::LoadU(d, b + int64_t(n) * p.b_stride + v * kLanes);
    }
    for (size_t m = 0; m < kRows; ++m) {
      const FloatVec x = hn::Set(d, a[int64_t(m) * p.a_stride + k]);
      for (size_t n = 0; n < kPanels; ++n) {
        for (size_t v = 0; v < kVectors; ++v) sum[m][n][v] = hn::MulAdd(x, column[n][v], sum[m][n][v]);
      }
    }
  }
  // The sums so far are added last: the next tile begins while they are on their way.
  c += row * p.c_stride;
  for (size_t m = 0; m < kRows; ++m) {
    for (size_t n = 0; n < kPanels; ++n) {
      float* at = c + int64_t(m) * p.c_stride + int64_t(n) * p.c_panel_stride;
      for (size_t v = 0; v < kVectors; ++v) {
        float* to = at + v * kLanes;
        hn::StoreU(p.accumulate ? hn::Add(hn::LoadU(d, to), sum[m][n][v]) : sum[m][n][v], d, to);
      }
    }
  }
}

/// The last rows, fewer than fill a tile: one tile of as many rows.
template <size_t kRows, size_t kPanels>
HWY_INLINE void multiply_last(const PanelProduct& p, const float* b, float* c, int64_t row) {
  if constexpr (kRows > 0) {
    if (p.rows - row == int64_t(kRows)) {
      multiply_tile<kRows, kPanels>(p, b, c, row);
    } else {
      multiply_last<kRows - 1, kPanels>(p, b, c, row);
    }
  }
}

template <size_t kPanels>
HWY_INLINE void multiply_joined(const PanelProduct& p, const float* b, float* c) {
  int64_t row = 0;
  for (; row + int64_t(kTile) <= p.rows; row += int64_t(kTile)) multiply_tile<kTile, kPanels>(p, b, c, row);
  multiply_last<kTile - 1, kPanels>(p, b, c, row);
}

void MultiplyPanels(const PanelProduct& p) {
  int64_t n = 0;
  if constexpr (kJoined > 1) {
    for (; n + int64_t(kJoined) <= p.panels; n += int64_t(kJoined))
      multiply_joined<kJoined>(p, p.b + n * p.b_stride, p.c + n * p.c_panel_stride);
  }
  for (; n < p.panels; ++n) multiply_joined<1>(p, p.b + n * p.b_stride, p.c + n * p.c_panel_stride);
}

void Widen(const uint16_t* bits, int64_t count, HalfFormat format, float* out) {
  const FloatTag d;
  const hn::Rebind<uint16_t, FloatTag> d16;
  const hn::Rebind<hwy::float16_t, FloatTag> half;
  const hn::RebindToUnsigned<FloatTag> d32;
  constexpr int64_t kStep = int64_t(kLanes);
  int64_t i = 0;
  if (format == HalfFormat::kBfloat16) {
    for (; i + kStep <= count; i += kStep) {
      const auto wide = hn::ShiftLeft<16>(hn::PromoteTo(d32, hn::LoadU(d16, bits + i)));
      hn::StoreU(hn::BitCast(d, wide), d, out + i);
    }
    for (; i < count; ++i) out[i] = bfloat16_to_float(bits[i]);
  } else {
    for (; i + kStep <= count; i += kStep)
      hn::StoreU(hn::PromoteTo(d, hn::BitCast(half, hn::LoadU(d16, bits + i))), d, out + i);
    for (; i < count; ++i) out[i] = half_to_float(bits[i]);
  }
}

/// The largest of `first` and the keys' scores. Four at once, since each waits for the one before.
HWY_INLINE FloatVec most_of(const float* scores, int64_t keys, FloatVec first) {
  const FloatTag d;
  FloatVec most[4] = {first, first, first, first};
  int64_t k = 0;
  for (; k + 4 <= keys; k += 4) {
    for (int64_t i = 0; i < 4; ++i) most[i] = hn::Max(most[i], hn::LoadU(d, scores + (k + i) * kPanel));
  }
  for (; k < keys; ++k) most[0] = hn::Max(most[0], hn::LoadU(d, scores + k * kPanel));
  return hn::Max(hn::Max(most[0], most[1]), hn::Max(most[2], most[3]));
}

/// Scores become weights; returns their sum, of even and odd keys apart.
HWY_INLINE FloatVec weigh(float* scores, int64_t keys, FloatVec most) {
  const FloatTag d;
  const auto weigh_one = [&](int64_t k) HWY_ATTR {
    const FloatVec weight = exp2_of(hn::Sub(hn::LoadU(d, scores + k * kPanel), most));
    hn::StoreU(weight, d, scores + k * kPanel);
    return weight;
  };
  FloatVec even = hn::Zero(d), odd = hn::Zero(d);
  int64_t k = 0;
  for (; k + 2 <= keys; k += 2) {
    even = hn::Add(even, weigh_one(k));
    odd = hn::Add(odd, weigh_one(k + 1));
  }
  if (k < keys) even = hn::Add(even, weigh_one(k));
  return hn::Add(even, odd);
}

void Step(const SoftmaxStep& s) {
  const FloatTag d;
  for (size_t v = 0; v < kVectors; ++v) {
    const size_t lane = v * kLanes;
    const FloatVec before = hn::LoadU(d, s.most + lane);
    const FloatVec most = most_of(s.scores + lane, s.keys, before);
    const FloatVec total = weigh(s.scores + lane, s.keys, most);
    const FloatVec change = exp2_of(hn::Sub(before, most));
    hn::StoreU(most, d, s.most + lane);
    hn::StoreU(hn::MulAdd(hn::LoadU(d, s.total + lane), change, total), d, s.total + lane);
    if (hn::AllTrue(d, hn::Eq(before, most))) continue;  // the sums stay as they are
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

HWY_EXPORT(MultiplyPanels);
HWY_EXPORT(Widen);
HWY_EXPORT(Step);

void multiply_panels(const PanelProduct& product) { HWY_DYNAMIC_DISPATCH(MultiplyPanels)(product); }
void widen(const uint16_t* bits, int64_t count, HalfFormat format, float* out) {
  HWY_DYNAMIC_DISPATCH(Widen)(bits, count, format, out);
}
void softmax_step(const SoftmaxStep& step) { HWY_DYNAMIC_DISPATCH(Step)(step); }

}  // namespace aligngs::nn
#endif  // HWY_ONCE
