// Semantic loss of one pixel by the formulas of engine/formulas/semantic_loss.h; compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_SEMANTIC_PIXEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_SEMANTIC_PIXEL_INL_H_
#undef ALIGNGS_ENGINE_CPU_SEMANTIC_PIXEL_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_SEMANTIC_PIXEL_INL_H_
#endif

#include <cmath>

#include <hwy/highway.h>

#include "engine/cpu/semantic_block.h"
#include "engine/cpu/simd_math-inl.h"
#include "engine/formulas/semantic_loss.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// 1 / x for normal x, within 2 ulp where the processor's estimate has 12 bits or more.
HWY_INLINE FloatVec reciprocal(FloatVec x) {
  const FloatTag d;
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
  const FloatVec r = hn::ApproximateReciprocal(x);
  return hn::Mul(r, hn::NegMulAdd(x, r, hn::Set(d, 2.0f)));
#else
  return hn::Div(hn::Set(d, 1.0f), x);
#endif
}

/// One pixel's part of the block's terms.
struct PixelTerms {
  float soft, hard;
  float likelihood = 1;    ///< -log of it is still to be added to `hard`
  float gradient_sum = 0;  ///< sum over all classes of g, kPlain coupling of probabilities only
};
/// One valid pixel; pointers are to padded rows. The teacher is near + share (far - near).
struct PixelData {
  float* HWY_RESTRICT blended;
  float* HWY_RESTRICT direction;  ///< nullptr without the bounded coupling
  const float* near_column;
  const float* far_column;
  float share = 0;
  float* HWY_RESTRICT student;
  float* HWY_RESTRICT teacher;
  int top = 0;
  float negative_entropy = 0, alpha = 0, omega = 0;

  HWY_INLINE FloatVec teacher_at(size_t c) const {
    const FloatTag d;
    const FloatVec a = hn::Load(d, near_column + c);
    return hn::MulAdd(hn::Set(d, share), hn::Sub(hn::Load(d, far_column + c), a), a);
  }
};

/// semantic_loss_probabilities and bounded_coupling_probabilities in one pass.
template <bool kBounded>
PixelTerms probabilities_pixel(const PixelData& px, const SemanticStep& step, const SemanticWeights<float>& weights) {
  const FloatTag d;
  const ClassCounts& classes = *step.counts;
  const float* HWY_RESTRICT count = classes.count.data();
  const float* HWY_RESTRICT inverse_count = classes.inverse.data();
  const float* HWY_RESTRICT floors = classes.floor.data();
  const float remainder = (1.0f - px.alpha) / static_cast<float>(classes.all_classes());
  const bool covered = px.alpha >= static_cast<float>(kCouplingAlphaMin);
  const float inverse_alpha = covered ? 1.0f / px.alpha : 0.0f, omega = covered ? px.omega * inverse_alpha : 0.0f;
  const FloatVec rest = hn::Set(d, remainder), soft_weight = hn::Set(d, -weights.soft);
  FloatVec cross = hn::Zero(d), sum = hn::Zero(d);
  const float top_q = px.blended[px.top] + remainder, top_floor = floors[px.top];
  for (size_t c = 0; c < step.padded; c += kLanes) {
    const FloatVec b = hn::Load(d, px.blended + c), t = px.teacher_at(c), n = hn::Load(d, count + c);
    const FloatVec lowest = hn::Load(d, floors + c);
    const FloatVec q = hn::MulAdd(rest, n, b);
    const FloatVec bounded = hn::Max(q, lowest);
    cross = hn::MulAdd(t, loss_log(bounded), cross);
    const FloatVec g = hn::IfThenElseZero(hn::Gt(q, lowest), hn::Mul(hn::Mul(soft_weight, t), reciprocal(bounded)));
    hn::Store(g, d, px.blended + c);
    if constexpr (kBounded) {
      // The difference of the remainder is spread over its classes: their squares add up to its square / n.
      const FloatVec e = hn::MulSub(b, hn::Set(d, inverse_alpha), t);
      hn::Store(hn::Mul(hn::Mul(hn::Set(d, omega), e), hn::Load(d, inverse_count + c)), d, px.direction + c);
    } else {
      sum = hn::MulAdd(g, n, sum);
    }
  }
  const bool above = top_q > top_floor;
  const float hard_gradient = above ? weights.hard / top_q : 0.0f;
  px.blended[px.top] -= hard_gradient;
  PixelTerms terms{px.negative_entropy - hn::GetLane(hn::SumOfLanes(d, cross)), 0.0f};
  terms.likelihood = above ? top_q : top_floor;
  if constexpr (!kBounded) terms.gradient_sum = hn::GetLane(hn::SumOfLanes(d, sum)) - hard_gradient;
  return terms;
}

/// semantic_loss_logits and bounded_coupling_logits.
template <bool kBounded>
PixelTerms logits_pixel(const PixelData& px, const SemanticStep& step, const SemanticWeights<float>& weights) {
  const FloatTag d;
  const float* HWY_RESTRICT count = step.counts->count.data();
  const float* HWY_RESTRICT inverse_count = step.counts->inverse.data();
  const float* HWY_RESTRICT log_count = step.counts->log_count.data();
  const FloatVec lowest = hn::Set(d, -3.0e38f), zero = hn::Zero(d);
  FloatVec top = lowest;
  for (size_t c = 0; c < step.padded; c += kLanes) {
    const auto real = hn::Gt(hn::Load(d, count + c), zero);
    top = hn::Max(top, hn::IfThenElse(real, hn::Load(d, px.blended + c), lowest));
  }
  const FloatVec highest = hn::MaxOfLanes(d, top);
  FloatVec sum = zero, mass = zero, cross = zero;
  const float logit_top = px.blended[px.top];
  for (size_t c = 0; c < step.padded; c += kLanes) {
    const FloatVec t = px.teacher_at(c);
    const FloatVec shifted = hn::Sub(hn::Load(d, px.blended + c), highest);
    const FloatVec e = hn::Mul(hn::Load(d, count + c), fast_exp(d, shifted));
    hn::Store(e, d, px.student + c);
    hn::Store(t, d, px.teacher + c);
    sum = hn::Add(sum, e);
    mass = hn::Add(mass, t);
    cross = hn::MulAdd(t, hn::Add(shifted, hn::Load(d, log_count + c)), cross);
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
      along = hn::MulAdd(q, hn::Mul(hn::Sub(q, t), hn::Load(d, inverse_count + c)), along);
    }
  }
  px.blended[px.top] -= weights.hard;
  if constexpr (kBounded) {
    const FloatVec mean = hn::SumOfLanes(d, along);
    const FloatVec omega = hn::Set(d, px.alpha >= static_cast<float>(kCouplingAlphaMin) ? px.omega : 0.0f);
    for (size_t c = 0; c < step.padded; c += kLanes) {
      const FloatVec t = hn::Load(d, px.teacher + c), q = hn::Load(d, px.student + c);
      const FloatVec e = hn::Mul(hn::Sub(q, t), hn::Load(d, inverse_count + c));
      hn::Store(hn::Mul(hn::Mul(omega, q), hn::Sub(e, mean)), d, px.direction + c);
    }
  }
  const float cross_sum = hn::GetLane(hn::SumOfLanes(d, cross)), top_value = hn::GetLane(highest);
  return {px.negative_entropy - cross_sum + mass_sum * log_sum, top_value + log_sum - logit_top};
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
