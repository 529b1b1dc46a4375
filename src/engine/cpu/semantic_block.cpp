#include "engine/cpu/semantic_block.h"

#include <cmath>
#include <cstring>

#include "engine/cpu/simd_targets.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/formulas/teacher_sampling.h"
#include "scene/triangle_mesh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/semantic_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// kLanes half-precision numbers as float.
HWY_INLINE FloatVec load_half(const uint16_t* p) {
  const FloatTag d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3  // these convert in hardware
  const hn::Rebind<hwy::float16_t, FloatTag> dh;
  return hn::PromoteTo(d, hn::LoadU(dh, reinterpret_cast<const hwy::float16_t*>(p)));
#else
  HWY_ALIGN float values[kLanes];
  for (size_t i = 0; i < kLanes; ++i) values[i] = half_to_float(p[i]);
  return hn::Load(d, values);
#endif
}

/// out[0 .. channels) (+)= weight * row, in float like sample_teacher.
template <bool kFirst>
void add_tap(const uint16_t* row, float weight, size_t channels, float* HWY_RESTRICT out) {
  const FloatTag d;
  const FloatVec w = hn::Set(d, weight);
  size_t c = 0;
  for (; c + kLanes <= channels; c += kLanes) {
    const FloatVec t = load_half(row + c);
    hn::Store(kFirst ? hn::Mul(w, t) : hn::MulAdd(w, t, hn::Load(d, out + c)), d, out + c);
  }
  if (c < channels) {  // the tail is copied so that nothing behind the map is read
    uint16_t tail[kLanes] = {};
    std::memcpy(tail, row + c, (channels - c) * sizeof(uint16_t));
    const FloatVec t = load_half(tail);
    hn::Store(kFirst ? hn::Mul(w, t) : hn::MulAdd(w, t, hn::Load(d, out + c)), d, out + c);
    c += kLanes;
  }
  if (kFirst) std::memset(out + c, 0, (padded_channels(static_cast<int>(channels)) - c) * sizeof(float));
}

void SampleTeacher(const SemanticTarget& target, const TeacherTaps& taps, float* teacher) {
  const size_t channels = static_cast<size_t>(target.channels);
  bool first = true;
  for (int k = 0; k < 4; ++k) {
    if (taps.weight[k] == 0) continue;
    const uint16_t* row = &target.probabilities[size_t(taps.pixel[k]) * channels];
    if (first) {
      add_tap<true>(row, taps.weight[k], channels, teacher);
    } else {
      add_tap<false>(row, taps.weight[k], channels, teacher);
    }
    first = false;
  }
}

/// sum t log t over a padded row.
float NegativeEntropy(const float* teacher, size_t padded) {
  const FloatTag d;
  const FloatVec smallest = hn::Set(d, 1.17549435e-38f);  // log needs a normal number; 0 log 0 = 0
  FloatVec sum = hn::Zero(d);
  for (size_t c = 0; c < padded; c += kLanes) {
    const FloatVec t = hn::Load(d, teacher + c);
    sum = hn::MulAdd(t, fast_log(d, hn::Max(t, smallest)), sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

/// What one pixel adds to the block's terms.
struct PixelTerms {
  float soft, hard;
};
/// One valid pixel; pointers are to padded rows.
struct PixelData {
  float* HWY_RESTRICT blended;
  float* HWY_RESTRICT direction;  ///< nullptr without the bounded coupling
  const float* HWY_RESTRICT teacher;
  float* HWY_RESTRICT student;
  int top = 0;
  float negative_entropy = 0, alpha = 0, omega = 0;
};

/// semantic_loss_probabilities and bounded_coupling_probabilities in one pass.
template <bool kBounded>
PixelTerms probabilities_pixel(const PixelData& px, const SemanticStep& step, const SemanticWeights<float>& weights) {
  const FloatTag d;
  const float floor = semantic_floor<float>(step.channels), remainder = (1.0f - px.alpha) / step.channels;
  const bool covered = px.alpha >= static_cast<float>(kCouplingAlphaMin);
  const float inverse_alpha = covered ? 1.0f / px.alpha : 0.0f, omega = covered ? px.omega * inverse_alpha : 0.0f;
  const FloatVec lowest = hn::Set(d, floor), rest = hn::Set(d, remainder), soft_weight = hn::Set(d, -weights.soft);
  FloatVec cross = hn::Zero(d);
  const float top_q = px.blended[px.top] + remainder;
  for (size_t c = 0; c < step.padded; c += kLanes) {
    const FloatVec b = hn::Load(d, px.blended + c), t = hn::Load(d, px.teacher + c);
    const FloatVec q = hn::Add(b, rest);
    const FloatVec bounded = hn::Max(q, lowest);
    cross = hn::MulAdd(t, fast_log(d, bounded), cross);
    const FloatVec g = hn::Div(hn::Mul(soft_weight, t), bounded);
    hn::Store(hn::IfThenElseZero(hn::Gt(q, lowest), g), d, px.blended + c);
    if constexpr (kBounded) {
      const FloatVec e = hn::MulSub(b, hn::Set(d, inverse_alpha), t);
      hn::Store(hn::Mul(hn::Set(d, omega), e), d, px.direction + c);
    }
  }
  const bool above = top_q > floor;
  if (above) px.blended[px.top] -= weights.hard / top_q;
  return {px.negative_entropy - hn::GetLane(hn::SumOfLanes(d, cross)), -std::log(above ? top_q : floor)};
}

/// semantic_loss_logits and bounded_coupling_logits.
template <bool kBounded>
PixelTerms logits_pixel(const PixelData& px, const SemanticStep& step, const SemanticWeights<float>& weights) {
  const FloatTag d;
  const FloatVec lowest = hn::Set(d, -3.0e38f), zero = hn::Zero(d);
  const size_t channels = static_cast<size_t>(step.channels);
  const auto real = [&](size_t c) HWY_ATTR { return hn::FirstN(d, channels > c ? channels - c : 0); };
  FloatVec top = lowest;
  for (size_t c = 0; c < step.padded; c += kLanes) {
    top = hn::Max(top, hn::IfThenElse(real(c), hn::Load(d, px.blended + c), lowest));
  }
  const FloatVec highest = hn::MaxOfLanes(d, top);
  FloatVec sum = zero, mass = zero, cross = zero;
  const float logit_top = px.blended[px.top];
  for (size_t c = 0; c < step.padded; c += kLanes) {
    const FloatVec t = hn::Load(d, px.teacher + c);
    const FloatVec shifted = hn::Sub(hn::Load(d, px.blended + c), highest);
    const FloatVec e = hn::IfThenElseZero(real(c), fast_exp(d, shifted));
    hn::Store(e, d, px.student + c);
    sum = hn::Add(sum, e);
    mass = hn::Add(mass, t);
    cross = hn::MulAdd(t, shifted, cross);
  }
  const float total = hn::GetLane(hn::SumOfLanes(d, sum)), mass_sum = hn::GetLane(hn::SumOfLanes(d, mass));
  const float log_sum = std::log(total);
  const FloatVec inverse = hn::Set(d, 1.0f / total);
  const FloatVec student_weight = hn::Set(d, weights.soft * mass_sum + weights.hard);
  FloatVec along = zero;
  for (size_t c = 0; c < step.padded; c += kLanes) {
    const FloatVec t = hn::Load(d, px.teacher + c), q = hn::Mul(hn::Load(d, px.student + c), inverse);
    hn::Store(hn::NegMulAdd(hn::Set(d, weights.soft), t, hn::Mul(student_weight, q)), d, px.blended + c);
    if constexpr (kBounded) {
      hn::Store(q, d, px.student + c);
      along = hn::MulAdd(q, hn::Sub(q, t), along);
    }
  }
  px.blended[px.top] -= weights.hard;
  if constexpr (kBounded) {
    const FloatVec mean = hn::SumOfLanes(d, along);
    const FloatVec omega = hn::Set(d, px.alpha >= static_cast<float>(kCouplingAlphaMin) ? px.omega : 0.0f);
    for (size_t c = 0; c < step.padded; c += kLanes) {
      const FloatVec t = hn::Load(d, px.teacher + c), q = hn::Load(d, px.student + c);
      hn::Store(hn::Mul(hn::Mul(omega, q), hn::Sub(hn::Sub(q, t), mean)), d, px.direction + c);
    }
  }
  const float cross_sum = hn::GetLane(hn::SumOfLanes(d, cross));
  return {px.negative_entropy - cross_sum + mass_sum * log_sum, hn::GetLane(highest) + log_sum - logit_top};
}

void SemanticBlockLoss(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch) {
  const SemanticTarget& target = step.view->data.semantics;
  const int width = step.view->data.camera.width, height = step.view->data.camera.height;
  const bool probabilities = step.losses->semantic_blend == SemanticBlend::kProbabilities;
  const bool bounded = step.couple && step.losses->coupling == SemanticCoupling::kBounded;
  const float inverse_valid = 1.0f / static_cast<float>(step.cache->valid);
  const SemanticWeights<float> weights{step.losses->semantic_soft_weight * inverse_valid,
                                       step.losses->semantic_hard_weight * inverse_valid};
  const ImageF& omega = step.view->semantic_weight;
  scratch.direction.resize(bounded ? kBlockPixels * step.padded : 0);
  scratch.teacher.resize(step.padded);
  scratch.student.resize(step.padded);
  scratch.soft = scratch.hard = 0;
  for (int i = 0; i < kBlockPixels; ++i) {
    const int x = block.x + i % kBlockSize, y = block.y + i / kBlockSize;
    float* blended = scratch.blended.data() + i * step.padded;
    float* direction = bounded ? scratch.direction.data() + i * step.padded : nullptr;
    scratch.offset[i] = 0;
    const bool inside = x < width && y < height;
    const size_t u = size_t(y) * width + x;
    if (!inside || step.cache->top_class[u] == kNoLabel) {
      std::memset(blended, 0, step.padded * sizeof(float));
      if (bounded) std::memset(direction, 0, step.padded * sizeof(float));
      continue;
    }
    SampleTeacher(target, teacher_taps(target, x, y, width, height), scratch.teacher.data());
    PixelData px{blended, direction, scratch.teacher.data(), scratch.student.data()};
    px.top = step.cache->top_class[u];
    px.negative_entropy = step.cache->negative_entropy[u];
    px.alpha = 1.0f - block.transmittance[i];
    px.omega = (omega.empty() ? 1.0f : omega.data[u]) * inverse_valid;
    PixelTerms terms;
    if (probabilities) {
      terms = bounded ? probabilities_pixel<true>(px, step, weights) : probabilities_pixel<false>(px, step, weights);
    } else {
      terms = bounded ? logits_pixel<true>(px, step, weights) : logits_pixel<false>(px, step, weights);
    }
    if (step.couple && !bounded) {
      scratch.offset[i] = plain_coupling_offset(probabilities, blended, step.channels);
    }
    scratch.soft += static_cast<double>(terms.soft);
    scratch.hard += static_cast<double>(terms.hard);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(SampleTeacher);
HWY_EXPORT(NegativeEntropy);
HWY_EXPORT(SemanticBlockLoss);

bool block_has_teacher(const SemanticStep& step, const BlockWeights& block) {
  const int width = step.view->data.camera.width, height = step.view->data.camera.height;
  for (int y = block.y; y < block.y + kBlockSize && y < height; ++y) {
    for (int x = block.x; x < block.x + kBlockSize && x < width; ++x) {
      if (step.cache->top_class[size_t(y) * width + x] != kNoLabel) return true;
    }
  }
  return false;
}

void prepare_semantic_view(const TrainingView& view, ThreadPool& pool, SemanticView& out) {
  const SemanticTarget& target = view.data.semantics;
  const int width = view.data.camera.width, height = view.data.camera.height;
  const size_t padded = padded_channels(target.channels);
  out.negative_entropy.assign(size_t(width) * height, 0.0f);
  out.top_class.assign(size_t(width) * height, kNoLabel);
  std::vector<size_t> valid(static_cast<size_t>(height), 0);
  SemanticStep step;
  step.view = &view;
  pool.parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end, int) {
    AlignedArray<float> teacher(padded);
    for (size_t y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!sample_teacher_padded(step, x, static_cast<int>(y), teacher.data())) continue;
        out.negative_entropy[y * width + x] = HWY_DYNAMIC_DISPATCH(NegativeEntropy)(teacher.data(), padded);
        out.top_class[y * width + x] = static_cast<uint16_t>(arg_max(teacher.data(), target.channels));
        ++valid[y];
      }
    }
  });
  out.valid = 0;
  for (const size_t n : valid) out.valid += n;
  out.ready = true;
}

void semantic_block_loss(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch) {
  HWY_DYNAMIC_DISPATCH(SemanticBlockLoss)(step, block, scratch);
}

bool sample_teacher_padded(const SemanticStep& step, int x, int y, float* teacher) {
  const ViewData& data = step.view->data;
  const TeacherTaps taps = teacher_taps(data.semantics, x, y, data.camera.width, data.camera.height);
  if (!semantic_pixel_valid(data, taps, x, y)) return false;
  HWY_DYNAMIC_DISPATCH(SampleTeacher)(data.semantics, taps, teacher);
  return true;
}

}  // namespace aligngs::cpu
#endif
