#include "engine/cpu/semantic_block.h"

#include <algorithm>
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

#include "engine/cpu/semantic_pixel-inl.h"
#include "engine/cpu/simd_math-inl.h"
#include "engine/cpu/teacher_window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

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

void SemanticBlockLoss(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch) {
  const SemanticTarget& target = step.view->data.semantics;
  const int width = step.view->data.camera.width, height = step.view->data.camera.height;
  const bool probabilities = step.losses->semantic_blend == SemanticBlend::kProbabilities;
  const bool bounded = step.couple && is_balanced(step.losses->coupling);
  const bool opacity = step.couple && step.losses->coupling == SemanticCoupling::kOpacity;
  const float pixel_weight = step.pixel_weight();
  const SemanticWeights<float> weights{step.losses->weight[Loss::kSemanticSoft] * pixel_weight,
                                       step.losses->weight[Loss::kSemanticHard] * pixel_weight};
  const ImageF& omega = step.view->semantic_weight;
  const TeacherWindow window = teacher_window(target, block.x, block.y, width, height);
  scratch.direction.resize(bounded ? kBlockPixels * step.padded : 0);
  scratch.teacher.resize(step.padded);
  scratch.student.resize(step.padded);
  scratch.columns.resize(window.separable ? static_cast<size_t>(window.columns) * step.padded : step.padded);
  if (window.separable) load_teacher_window(target, window, step.padded, scratch.window);
  scratch.soft = scratch.hard = 0;
  HWY_ALIGN float likelihood[kBlockPixels];
  std::fill(likelihood, likelihood + kBlockPixels, 1.0f);
  for (int i = 0; i < kBlockPixels; ++i) {
    const int column = i % kBlockSize, row = i / kBlockSize, x = block.x + column, y = block.y + row;
    float* blended = scratch.blended.data() + i * step.padded;
    float* direction = bounded ? scratch.direction.data() + i * step.padded : nullptr;
    scratch.offset[i] = 0;
    if (column == 0 && window.separable && y < height) {
      blend_teacher_rows(scratch.window.data(), window, row, step.padded, scratch.columns.data());
    }
    const bool inside = x < width && y < height;
    const size_t u = size_t(y) * width + x;
    if (!inside || step.cache->top_class[u] == kNoLabel) {
      std::memset(blended, 0, step.padded * sizeof(float));
      if (bounded) std::memset(direction, 0, step.padded * sizeof(float));
      continue;
    }
    PixelData px;
    px.blended = blended;
    px.direction = direction;
    px.student = scratch.student.data();
    px.teacher = scratch.teacher.data();
    if (window.separable) {
      px.near_column = scratch.columns.data() + (window.column0[column] - window.first_column) * step.padded;
      px.far_column = scratch.columns.data() + (window.column1[column] - window.first_column) * step.padded;
      px.share = window.column_share[column];
    } else {
      SampleTeacher(target, teacher_taps(target, x, y, width, height), scratch.columns.data());
      px.near_column = px.far_column = scratch.columns.data();
    }
    px.top = step.cache->top_class[u];
    px.negative_entropy = step.cache->negative_entropy[u];
    px.alpha = 1.0f - block.transmittance[i];
    px.omega = (omega.empty() ? 1.0f : omega.data[u]) * pixel_weight;
    if (opacity) {
      scratch.offset[i] = px.omega;
      px.omega = 0;
    }
    PixelTerms terms;
    if (probabilities) {
      terms = bounded ? probabilities_pixel<true>(px, step, weights) : probabilities_pixel<false>(px, step, weights);
    } else {
      terms = bounded ? logits_pixel<true>(px, step, weights) : logits_pixel<false>(px, step, weights);
    }
    // plain_coupling_offset of formulas/semantic_loss.h
    if (step.couple && !bounded && probabilities) {
      scratch.offset[i] = terms.gradient_sum / static_cast<float>(step.counts->all_classes());
    }
    scratch.soft += static_cast<double>(terms.soft);
    scratch.hard += static_cast<double>(terms.hard);
    likelihood[i] = terms.likelihood;
  }
  const FloatTag d;
  for (size_t i = 0; i < kBlockPixels; i += kLanes) hn::Store(loss_log(hn::Load(d, likelihood + i)), d, likelihood + i);
  for (const float log_likelihood : likelihood) scratch.hard -= static_cast<double>(log_likelihood);
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

ClassCounts make_class_counts(int channels, int remainder) {
  ClassCounts k;
  k.channels = channels;
  k.remainder = remainder;
  const size_t padded = padded_channels(channels);
  k.count.assign(padded, 0.0f);
  k.inverse.assign(padded, 0.0f);
  k.log_count.assign(padded, 0.0f);
  k.floor.assign(padded, 1.0f);
  const float floor = semantic_floor<float>(k.all_classes());
  for (int c = 0; c < channels; ++c) {
    const float n = remainder > 0 && c == channels - 1 ? static_cast<float>(remainder) : 1.0f;
    k.count[static_cast<size_t>(c)] = n;
    k.inverse[static_cast<size_t>(c)] = 1.0f / n;
    k.log_count[static_cast<size_t>(c)] = std::log(n);
    k.floor[static_cast<size_t>(c)] = n * floor;
  }
  return k;
}

bool block_has_teacher(const SemanticStep& step, const BlockWeights& block) {
  if (!step.losses->semantic_sample.takes(block.x, block.y)) return false;
  const int width = step.view->data.camera.width, height = step.view->data.camera.height;
  for (int y = block.y; y < block.y + kBlockSize && y < height; ++y) {
    for (int x = block.x; x < block.x + kBlockSize && x < width; ++x) {
      if (step.cache->top_class[size_t(y) * width + x] != kNoLabel) return true;
    }
  }
  return false;
}

/// sum t log t over a padded row.
static float negative_entropy(const float* teacher, size_t padded) {
  return HWY_DYNAMIC_DISPATCH(NegativeEntropy)(teacher, padded);
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

namespace aligngs {

void prepare_semantic_view(const TrainingView& view, int classes, ThreadPool& pool, SemanticView& out) {
  const SemanticTarget& target = view.data.semantics;
  const int width = view.data.camera.width, height = view.data.camera.height;
  const size_t padded = cpu::padded_channels(target.channels);
  out.negative_entropy.assign(size_t(width) * height, 0.0f);
  out.top_class.assign(size_t(width) * height, kNoLabel);
  std::vector<size_t> valid(static_cast<size_t>(height), 0);
  cpu::SemanticStep step;
  step.view = &view;
  pool.parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end, int) {
    cpu::AlignedArray<float> teacher(padded);
    for (size_t y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!cpu::sample_teacher_padded(step, x, static_cast<int>(y), teacher.data())) continue;
        out.negative_entropy[y * width + x] = cpu::negative_entropy(teacher.data(), padded);
        out.top_class[y * width + x] = static_cast<uint16_t>(arg_max(teacher.data(), classes));
        ++valid[y];
      }
    }
  });
  out.valid = 0;
  for (const size_t n : valid) out.valid += n;
  out.ready = true;
}

}  // namespace aligngs
#endif
