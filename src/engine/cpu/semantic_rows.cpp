#include "engine/cpu/semantic_rows.h"

#include <cstring>

#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/semantic_rows.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

void SoftmaxRow(const float* logits, size_t channels, size_t padded, float last_shift, float* out) {
  const FloatTag d;
  const FloatVec lowest = hn::Set(d, -3.0e38f);
  FloatVec top = lowest;
  size_t whole = 0;
  for (; whole + kLanes <= channels; whole += kLanes) {
    const FloatVec x = hn::LoadU(d, logits + whole);
    hn::Store(x, d, out + whole);
    top = hn::Max(top, x);
  }
  std::memcpy(out + whole, logits + whole, (channels - whole) * sizeof(float));
  for (size_t c = channels; c < padded; ++c) out[c] = -3.0e38f;
  out[channels - 1] += last_shift;  // never negative: the maximum of the vectors above can only grow
  for (size_t c = (channels - 1) / kLanes * kLanes; c < padded; c += kLanes) top = hn::Max(top, hn::Load(d, out + c));
  top = hn::MaxOfLanes(d, top);
  FloatVec sum = hn::Zero(d);
  for (size_t c = 0; c < padded; c += kLanes) {
    const FloatVec x = hn::Load(d, out + c);
    const FloatVec e = hn::IfThenElseZero(hn::Gt(x, lowest), fast_exp(d, hn::Sub(x, top)));
    hn::Store(e, d, out + c);
    // 0 x is NaN for a logit that is not finite; max and exp would hide it.
    sum = hn::Add(sum, hn::MulAdd(x, hn::Zero(d), e));
  }
  const FloatVec inverse = hn::Div(hn::Set(d, 1.0f), hn::SumOfLanes(d, sum));
  for (size_t c = 0; c < padded; c += kLanes) hn::Store(hn::Mul(hn::Load(d, out + c), inverse), d, out + c);
}

void RoundRow(const float* HWY_RESTRICT in, size_t channels, size_t padded, size_t depth, float shift,
              uint16_t* HWY_RESTRICT out) {
  const FloatTag d;
  const hn::RebindToUnsigned<FloatTag> du;
  const hn::RebindToSigned<FloatTag> di;
  const hn::Rebind<uint16_t, FloatTag> dh;
  const FloatVec offset = hn::Set(d, shift);
  for (size_t c = 0; c < padded; c += kLanes) {
    const FloatVec x =
        hn::IfThenElseZero(hn::FirstN(d, channels > c ? channels - c : 0), hn::Sub(hn::Load(d, in + c), offset));
    const auto bits = hn::BitCast(du, x);
    const auto odd = hn::And(hn::ShiftRight<16>(bits), hn::Set(du, 1));
    const auto rounded = hn::ShiftRight<16>(hn::Add(bits, hn::Add(odd, hn::Set(du, 0x7fff))));
    const auto nan = hn::RebindMask(di, hn::Ne(x, x));
    const auto result = hn::IfThenElse(nan, hn::Set(di, 0x7fc0), hn::BitCast(di, rounded));
    hn::StoreU(hn::DemoteTo(dh, result), dh, out + c);
  }
  std::memset(out + padded, 0, (depth - padded) * sizeof(uint16_t));
}

float RowMean(const float* HWY_RESTRICT in, size_t channels, size_t padded) {
  const FloatTag d;
  FloatVec sum = hn::Zero(d);
  for (size_t c = 0; c < padded; c += kLanes) sum = hn::Add(sum, hn::Load(d, in + c));  // the padding is zero
  return hn::GetLane(hn::SumOfLanes(d, sum)) / static_cast<float>(channels);
}

void StreamRow(const float* HWY_RESTRICT in, size_t padded, float* HWY_RESTRICT out) {
  const FloatTag d;
  for (size_t c = 0; c < padded; c += kLanes) hn::Stream(hn::Load(d, in + c), d, out + c);
}

void AddRow(const float* HWY_RESTRICT in, size_t padded, float* HWY_RESTRICT out) {
  const FloatTag d;
  for (size_t c = 0; c < padded; c += kLanes) hn::Store(hn::Add(hn::Load(d, out + c), hn::Load(d, in + c)), d, out + c);
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(SoftmaxRow);
HWY_EXPORT(RoundRow);
HWY_EXPORT(RowMean);
HWY_EXPORT(StreamRow);
HWY_EXPORT(AddRow);

void softmax_row(const float* logits, size_t channels, size_t padded, float last_shift, float* out) {
  HWY_DYNAMIC_DISPATCH(SoftmaxRow)(logits, channels, padded, last_shift, out);
}
void copy_row(const float* in, size_t channels, size_t padded, float* out) {
  std::memcpy(out, in, channels * sizeof(float));
  std::memset(out + channels, 0, (padded - channels) * sizeof(float));
}
void round_row(const float* in, size_t channels, size_t padded, size_t depth, float shift, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(RoundRow)(in, channels, padded, depth, shift, out);
}
void round_features(const float* logits, size_t channels, size_t padded, size_t depth, bool probabilities,
                    float last_shift, float* scratch, uint16_t* out) {
  if (probabilities) {
    softmax_row(logits, channels, padded, last_shift, scratch);
  } else {
    copy_row(logits, channels, padded, scratch);
  }
  // A softmax of blended logits does not see a shift of a row, but the rounding does.
  const float shift = probabilities ? 0.0f : row_mean(scratch, channels, padded);
  round_row(scratch, channels, padded, depth, shift, out);
}
float row_mean(const float* in, size_t channels, size_t padded) {
  return HWY_DYNAMIC_DISPATCH(RowMean)(in, channels, padded);
}
void stream_row(const float* in, size_t padded, float* out) { HWY_DYNAMIC_DISPATCH(StreamRow)(in, padded, out); }
void finish_streams() { hwy::FlushStream(); }
void add_row(const float* in, size_t padded, float* out) { HWY_DYNAMIC_DISPATCH(AddRow)(in, padded, out); }

}  // namespace aligngs::cpu
#endif
