#include "engine/cpu/semantic_half_block.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "engine/cpu/simd_targets.h"
#include "engine/formulas/semantic_loss.h"
#include "scene/triangle_mesh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/semantic_half_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"
#include "engine/cpu/teacher_window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

bool BeginHalfBlocks(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch) {
  const SemanticTarget& target = step.view->data.semantics;
  scratch.soft = scratch.hard = 0;
  if (step.losses->semantic_blend != SemanticBlend::kProbabilities) return false;
  scratch.teacher_window =
      teacher_window(target, block.x, block.y, step.view->data.camera.width, step.view->data.camera.height);
  const TeacherWindow& window = scratch.teacher_window;
  if (!window.separable) return false;
  load_teacher_window(target, window, step.padded, scratch.window);
  scratch.columns.resize(static_cast<size_t>(window.columns) * step.padded);
  scratch.zeros.assign(step.padded, 0.0f);
  return true;
}

#if HWY_TARGET != HWY_SCALAR

/// One pixel. Without a loss, all pointers are to zeros and so are soft, omega and share.
struct PixelSide {
  const float *near_column, *far_column;  ///< the teacher is near + share (far - near)
  const float* blended;
  float share = 0;
  float rest = 0;           ///< (1 - A) / C
  float soft = 0;           ///< minus the weight of the soft term
  float omega = 0;          ///< of the coupling direction omega (B / A - t)
  float omega_inverse = 0;  ///< omega / A

  HWY_INLINE float teacher_at(size_t c) const { return near_column[c] + share * (far_column[c] - near_column[c]); }
};

/// The constants of a side, one per lane.
struct SideLanes {
  FloatVec share, rest, soft, omega, omega_inverse;
  explicit SideLanes(const PixelSide& s)
      : share(hn::Set(FloatTag(), s.share)),
        rest(hn::Set(FloatTag(), s.rest)),
        soft(hn::Set(FloatTag(), s.soft)),
        omega(hn::Set(FloatTag(), s.omega)),
        omega_inverse(hn::Set(FloatTag(), s.omega_inverse)) {}
};

/// Sums to which a pair of pixels adds.
struct PairSums {
  FloatVec cross;  ///< sum of t log2 Q
  float gradient_sum[2] = {0, 0};
};

/// Destination of a pair of pixels.
struct PairOutputs {
  uint16_t* HWY_RESTRICT gradients;      ///< [channel / 16] at kTileNumbers each, [channel % 16][2]
  uint16_t* HWY_RESTRICT directions[2];  ///< [depth] each
};

/// The upper half of each number after this is its rounding to bfloat16, ties away from zero.
HWY_INLINE hn::Vec<hn::RebindToUnsigned<FloatTag>> carry_half(FloatVec x) {
  const hn::RebindToUnsigned<FloatTag> du;
  return hn::Add(hn::BitCast(du, x), hn::Set(du, 0x8000));
}

/// kLanes channels of one side: the row gradient g and the coupling direction h.
template <bool kBounded, bool kRemainder>
HWY_INLINE void side_channels(const PixelSide& s, const SideLanes& k, const ClassCounts& classes, size_t c,
                              FloatVec& cross, FloatVec& sum, FloatVec& g, FloatVec& h) {
  const FloatTag d;
  const FloatVec near_t = hn::Load(d, s.near_column + c);
  const FloatVec t = hn::MulAdd(k.share, hn::Sub(hn::Load(d, s.far_column + c), near_t), near_t);
  const FloatVec b = hn::Load(d, s.blended + c), lowest = hn::Load(d, classes.floor.data() + c);
  const FloatVec q = kRemainder ? hn::MulAdd(k.rest, hn::Load(d, classes.count.data() + c), b) : hn::Add(b, k.rest);
  const FloatVec bounded = hn::Max(q, lowest);
  cross = hn::MulAdd(t, rough_log2(bounded), cross);
  // The estimate has 14 bits with AVX-512; bfloat16 keeps 8.
  const FloatVec steep = hn::Mul(hn::Mul(k.soft, t), hn::ApproximateReciprocal(bounded));
  g = hn::IfThenElseZero(hn::Gt(q, lowest), steep);
  if constexpr (kBounded) {
    // The difference of the remainder is spread over its classes: their squares add up to its square / n.
    h = hn::MulSub(k.omega_inverse, b, hn::Mul(k.omega, t));
    if constexpr (kRemainder) h = hn::Mul(h, hn::Load(d, classes.inverse.data() + c));
  } else {
    h = g;
    sum = hn::MulAdd(g, hn::Load(d, classes.count.data() + c), sum);
  }
}

/// semantic_loss_probabilities and the coupling's direction for two neighbouring pixels, without the hard term.
template <bool kBounded, bool kRemainder>
void pixel_pair(const PixelSide* sides, const ClassCounts& classes, size_t padded, size_t depth, PairSums& sums,
                const PairOutputs& out) {
  const FloatTag d;
  const hn::Repartition<uint16_t, FloatTag> dh;
  const SideLanes k0(sides[0]), k1(sides[1]);
  FloatVec cross = sums.cross, sum0 = hn::Zero(d), sum1 = hn::Zero(d);
  const auto half = hn::Zero(hn::RebindToUnsigned<FloatTag>());
  auto lower0 = half, lower1 = half;  // the directions of the first of two vectors
  const auto channels = [&](size_t c, bool second) HWY_ATTR {
    FloatVec g0, g1, h0, h1;
    side_channels<kBounded, kRemainder>(sides[0], k0, classes, c, cross, sum0, g0, h0);
    side_channels<kBounded, kRemainder>(sides[1], k1, classes, c, cross, sum1, g1, h1);
    const auto even = hn::BitCast(dh, hn::ShiftRight<16>(carry_half(g0))), odd = hn::BitCast(dh, carry_half(g1));
    hn::StoreU(hn::OddEven(odd, even), dh, out.gradients + c / kTileRows * kTileNumbers + c % kTileRows * 2);
    if (!second) {
      lower0 = carry_half(h0);
      lower1 = carry_half(h1);
      return;
    }
    hn::StoreU(hn::ConcatOdd(dh, hn::BitCast(dh, carry_half(h0)), hn::BitCast(dh, lower0)), dh,
               out.directions[0] + c - kLanes);
    hn::StoreU(hn::ConcatOdd(dh, hn::BitCast(dh, carry_half(h1)), hn::BitCast(dh, lower1)), dh,
               out.directions[1] + c - kLanes);
  };
  size_t c = 0;
  for (; c + 2 * kLanes <= padded; c += 2 * kLanes) {
    channels(c, false);
    channels(c + kLanes, true);
  }
  if (c < padded) {
    channels(c, false);
    hn::StoreU(hn::ConcatOdd(dh, hn::BitCast(dh, half), hn::BitCast(dh, lower0)), dh, out.directions[0] + c);
    hn::StoreU(hn::ConcatOdd(dh, hn::BitCast(dh, half), hn::BitCast(dh, lower1)), dh, out.directions[1] + c);
    c += 2 * kLanes;
  }
  for (; c < depth; c += 2 * kLanes) {  // products go over these numbers, too: they must not be what lay there
    for (uint16_t* direction : out.directions) hn::StoreU(hn::Zero(dh), dh, direction + c);
  }
  sums.cross = cross;
  if constexpr (!kBounded) {
    sums.gradient_sum[0] = hn::GetLane(hn::SumOfLanes(d, sum0));
    sums.gradient_sum[1] = hn::GetLane(hn::SumOfLanes(d, sum1));
  }
}

HWY_INLINE uint16_t rounded_number(float x) {
  uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return static_cast<uint16_t>((bits + 0x8000u) >> 16);
}

template <bool kBounded, bool kRemainder>
void half_block(const SemanticStep& step, const BlockWeights& block, size_t first, SemanticBlock& scratch,
                const HalfBlockOutputs& out) {
  const FloatTag d;
  const ClassCounts& classes = *step.counts;
  const int width = step.view->data.camera.width, height = step.view->data.camera.height;
  const float pixel_weight = step.pixel_weight();
  const float soft_weight = step.losses->weight[Loss::kSemanticSoft] * pixel_weight;
  const float hard_weight = step.losses->weight[Loss::kSemanticHard] * pixel_weight;
  const float inverse_classes = 1.0f / static_cast<float>(classes.all_classes());
  const bool opacity = step.losses->coupling == SemanticCoupling::kOpacity;
  const ImageF& omega_map = step.view->semantic_weight;
  const TeacherWindow& window = scratch.teacher_window;
  const size_t groups = step.padded / kTileRows;
  const float* zeros = scratch.zeros.data();
  HWY_ALIGN float likelihood[kHalfBlockPixels];
  PairSums sums{hn::Zero(d), {0, 0}};
  double entropy = 0;
  for (size_t i = 0; i < kHalfBlockPixels; i += 2) {
    const int column = static_cast<int>(first + i) % kBlockSize, row = static_cast<int>(first + i) / kBlockSize;
    const int y = block.y + row;
    if (column == 0 && y < height) {
      blend_teacher_rows(scratch.window.data(), window, row, step.padded, scratch.columns.data());
    }
    PixelSide sides[2];
    int top[2] = {-1, -1};
    for (int s = 0; s < 2; ++s) {
      const size_t pixel = first + i + static_cast<size_t>(s);
      const int x = block.x + column + s;
      PixelSide& side = sides[s];
      side.near_column = side.far_column = side.blended = zeros;
      scratch.offset[pixel] = 0;
      likelihood[i + static_cast<size_t>(s)] = 1;
      if (x >= width || y >= height) continue;
      const size_t u = size_t(y) * width + x;
      if (step.cache->top_class[u] == kNoLabel) continue;
      top[s] = step.cache->top_class[u];
      const float* columns = scratch.columns.data();
      side.near_column = columns + (window.column0[column + s] - window.first_column) * step.padded;
      side.far_column = columns + (window.column1[column + s] - window.first_column) * step.padded;
      side.share = window.column_share[column + s];
      side.blended = scratch.blended.data() + (i + static_cast<size_t>(s)) * step.padded;
      const float alpha = 1.0f - block.transmittance[pixel];
      side.rest = (1.0f - alpha) * inverse_classes;
      side.soft = -soft_weight;
      const float omega = (omega_map.empty() ? 1.0f : omega_map.data[u]) * pixel_weight;
      if (opacity) {
        scratch.offset[pixel] = omega;
      } else if (alpha >= static_cast<float>(kCouplingAlphaMin)) {
        const float inverse_alpha = 1.0f / alpha;
        side.omega = omega * inverse_alpha;
        side.omega_inverse = side.omega * inverse_alpha;
      }
      entropy += static_cast<double>(step.cache->negative_entropy[u]);
    }
    const PairOutputs pair{out.gradient_pairs + (i / 2) * 2 * kTileRows,
                           {out.directions + i * out.depth, out.directions + (i + 1) * out.depth}};
    if (top[0] < 0 && top[1] < 0) {
      for (size_t g = 0; g < groups; ++g) {
        std::memset(pair.gradients + g * kTileNumbers, 0, 2 * kTileRows * sizeof(uint16_t));
      }
      std::memset(pair.directions[0], 0, 2 * out.depth * sizeof(uint16_t));
      continue;
    }
    pixel_pair<kBounded, kRemainder>(sides, classes, step.padded, out.depth, sums, pair);
    for (int s = 0; s < 2; ++s) {  // the arg-max has the hard term, too
      if (top[s] < 0) continue;
      const size_t c = static_cast<size_t>(top[s]);
      const float q = sides[s].blended[c] + sides[s].rest, floor = classes.floor[c];
      const bool above = q > floor;
      const float hard = above ? hard_weight / q : 0.0f;
      const float gradient = above ? sides[s].soft * sides[s].teacher_at(c) / q - hard : 0.0f;
      pair.gradients[c / kTileRows * kTileNumbers + c % kTileRows * 2 + static_cast<size_t>(s)] =
          rounded_number(gradient);
      likelihood[i + static_cast<size_t>(s)] = above ? q : floor;
      if constexpr (!kBounded) {  // plain_coupling_offset of formulas/semantic_loss.h
        pair.directions[s][c] = rounded_number(gradient);
        scratch.offset[first + i + static_cast<size_t>(s)] = (sums.gradient_sum[s] - hard) * inverse_classes;
      }
    }
  }
  constexpr double kLn2 = 0.69314718055994531;
  scratch.soft += entropy - kLn2 * static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sums.cross)));
  FloatVec logs = hn::Zero(d);
  for (size_t i = 0; i < kHalfBlockPixels; i += kLanes) logs = hn::Add(logs, rough_log2(hn::Load(d, likelihood + i)));
  scratch.hard -= kLn2 * static_cast<double>(hn::GetLane(hn::SumOfLanes(d, logs)));
}

void HalfBlockLoss(const SemanticStep& step, const BlockWeights& block, size_t first, SemanticBlock& scratch,
                   const HalfBlockOutputs& out) {
  const bool bounded = is_balanced(step.losses->coupling) || !step.couple;
  if (step.counts->remainder > 0) {
    bounded ? half_block<true, true>(step, block, first, scratch, out)
            : half_block<false, true>(step, block, first, scratch, out);
  } else {
    bounded ? half_block<true, false>(step, block, first, scratch, out)
            : half_block<false, false>(step, block, first, scratch, out);
  }
}

#else

void HalfBlockLoss(const SemanticStep&, const BlockWeights&, size_t, SemanticBlock&, const HalfBlockOutputs&) {
  throw_usage("a processor with matrix tiles has vectors");
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(BeginHalfBlocks);
HWY_EXPORT(HalfBlockLoss);

bool begin_half_blocks(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch) {
  return HWY_DYNAMIC_DISPATCH(BeginHalfBlocks)(step, block, scratch);
}
void half_block_loss(const SemanticStep& step, const BlockWeights& block, size_t first, SemanticBlock& scratch,
                     const HalfBlockOutputs& out) {
  HWY_DYNAMIC_DISPATCH(HalfBlockLoss)(step, block, first, scratch, out);
}

}  // namespace aligngs::cpu
#endif
