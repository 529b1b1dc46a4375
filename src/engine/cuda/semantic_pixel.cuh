// The semantic loss of one pixel by one warp; lane l holds channels l, l + 32, ... Formulas of
// formulas/semantic_loss.h, channel by channel from formulas/semantic_channel.h.
#pragma once

#ifndef ALIGNGS_CUDA_EMULATED
#include <cuda_fp16.h>
#endif

#include "engine/cuda/lane_channels.cuh"
#include "engine/cuda/semantic_visit.h"
#include "engine/formulas/semantic_channel.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/formulas/teacher_sampling.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cuda {

__device__ __forceinline__ float load_half(const uint16_t& bits) {
#ifdef ALIGNGS_CUDA_EMULATED
  return half_to_float(bits);
#else
  return __half2float(__ushort_as_half(bits));
#endif
}

/// Inputs of the loss besides those of the step.
struct PixelTeacher {
  int pixel[4];     ///< of the teacher's map
  float weight[4];  ///< TeacherTaps
  int top;          ///< arg-max class; negative: the pixel is not valid and the rest means nothing
  float negative_entropy, omega;
};

/// By one lane for pixel (x, y) of the image.
__device__ __forceinline__ PixelTeacher find_teacher(const SemanticVisitInputs& in, int x, int y) {
  PixelTeacher t;
  t.top = -1;
  if (x >= in.view.width || y >= in.view.height || !in.sample.takes(x, y)) return t;
  const size_t u = size_t(y) * in.view.width + x;
  const uint16_t top = in.teacher.top_class[u];
  if (top == kNoLabel) return t;
  const TeacherTaps taps = teacher_taps(in.teacher.grid(), x, y, in.view.width, in.view.height);
  for (int k = 0; k < 4; ++k) {
    t.pixel[k] = taps.pixel[k];
    t.weight[k] = taps.weight[k];
  }
  t.top = top;
  t.negative_entropy = in.teacher.negative_entropy[u];
  t.omega = (in.teacher.weight.empty() ? 1.0f : in.teacher.weight[u]) * in.pixel_weight();
  return t;
}

/// The same to all lanes from lane `source`.
__device__ __forceinline__ PixelTeacher share_teacher(const PixelTeacher& t, int source) {
  PixelTeacher out;
#pragma unroll
  for (int k = 0; k < 4; ++k) {
    out.pixel[k] = __shfl_sync(kFullWarp, t.pixel[k], source);
    out.weight[k] = __shfl_sync(kFullWarp, t.weight[k], source);
  }
  out.top = __shfl_sync(kFullWarp, t.top, source);
  out.negative_entropy = __shfl_sync(kFullWarp, t.negative_entropy, source);
  out.omega = __shfl_sync(kFullWarp, t.omega, source);
  return out;
}

/// Constants of a step.
struct ChannelSet {
  int channels, remainder;
  __device__ __forceinline__ float count(int c) const {
    return remainder > 1 && c == channels - 1 ? static_cast<float>(remainder) : 1.0f;
  }
  __device__ __forceinline__ int all_classes() const { return remainder > 1 ? channels - 1 + remainder : channels; }
};

/// Channels of a pixel: in, what is blended; out, row gradient and coupling direction.
template <int kGroups>
struct PixelChannels {
  float value[kGroups], direction[kGroups];
};

/// Unweighted terms and h_0, the same in every lane.
struct PixelLoss {
  float soft, hard, offset;
};

template <int kGroups>
__device__ __forceinline__ void sample_teacher_lanes(const TeacherSpans& teacher, const PixelTeacher& px,
                                                     float (&t)[kGroups]) {
#pragma unroll
  for (int g = 0; g < kGroups; ++g) t[g] = 0;
#pragma unroll
  for (int k = 0; k < 4; ++k) {
    if (px.weight[k] == 0) continue;
    const size_t first = static_cast<size_t>(px.pixel[k]) * static_cast<size_t>(teacher.stride);
#pragma unroll
    for (int g = 0; g < kGroups; ++g) {
      const int c = lane_channel(g);
      if (c < teacher.channels) t[g] += px.weight[k] * load_half(teacher.probabilities[first + static_cast<size_t>(c)]);
    }
  }
}

/// semantic_loss_probabilities, then bounded_coupling_probabilities or plain_coupling_offset.
template <int kGroups>
__device__ __forceinline__ PixelLoss probabilities_loss(const SemanticVisitInputs& in, const ChannelSet& set,
                                                        const PixelTeacher& px, const float (&t)[kGroups], float alpha,
                                                        bool bounded, PixelChannels<kGroups>& row) {
  const float soft = in.soft_weight * in.pixel_weight(), hard = in.hard_weight * in.pixel_weight();
  const float all = static_cast<float>(set.all_classes()), rest = (1 - alpha) / all;
  const float floor = semantic_floor<float>(set.all_classes());
  const bool covered = alpha >= static_cast<float>(kCouplingAlphaMin);
  const float inverse_alpha = covered ? 1.0f / alpha : 0.0f, omega = covered ? px.omega : 0.0f;
  float cross = 0, likelihood = 0, gradient_sum = 0;
#pragma unroll
  for (int g = 0; g < kGroups; ++g) {
    const int c = lane_channel(g);
    row.direction[g] = 0;
    if (c >= set.channels) {
      row.value[g] = 0;
      continue;
    }
    const float blended = row.value[g], count = set.count(c);
    const ProbabilityChannel<float> channel = probability_channel(blended, rest, count, floor);
    const float log_q = std::log(channel.q);
    cross += t[g] * log_q;
    if (c == px.top) likelihood = log_q;
    row.value[g] = probability_gradient(channel, t[g], soft, c == px.top ? hard : 0.0f);
    gradient_sum += row.value[g] * count;
    if (bounded) row.direction[g] = bounded_probability_direction(blended, inverse_alpha, t[g], omega, count);
  }
  PixelLoss loss{px.negative_entropy - warp_sum(cross), -warp_sum(likelihood), 0};
  if (!bounded) loss.offset = warp_sum(gradient_sum) / all;
  return loss;
}

/// semantic_loss_logits and bounded_coupling_logits.
template <int kGroups>
__device__ __forceinline__ PixelLoss logits_loss(const SemanticVisitInputs& in, const ChannelSet& set,
                                                 const PixelTeacher& px, const float (&t)[kGroups], float alpha,
                                                 bool bounded, PixelChannels<kGroups>& row) {
  const float soft = in.soft_weight * in.pixel_weight(), hard = in.hard_weight * in.pixel_weight();
  const float omega = alpha >= static_cast<float>(kCouplingAlphaMin) ? px.omega : 0.0f;
  const float log_remainder = set.remainder > 1 ? std::log(static_cast<float>(set.remainder)) : 0.0f;
  float top = -3.0e38f;
#pragma unroll
  for (int g = 0; g < kGroups; ++g) {
    if (lane_channel(g) < set.channels && row.value[g] > top) top = row.value[g];
  }
  top = warp_maximum(top);
  float q[kGroups], sum = 0, mass = 0, cross = 0, logit = 0;
#pragma unroll
  for (int g = 0; g < kGroups; ++g) {
    const int c = lane_channel(g);
    q[g] = 0;
    if (c >= set.channels) continue;
    const float shifted = row.value[g] - top;
    q[g] = set.count(c) * std::exp(shifted);
    sum += q[g];
    mass += t[g];
    cross += t[g] * (shifted + (c == set.channels - 1 ? log_remainder : 0.0f));
    if (c == px.top) logit = shifted;
  }
  sum = warp_sum(sum);
  mass = warp_sum(mass);
  const float log_sum = std::log(sum), inverse = 1.0f / sum;
  PixelLoss loss{px.negative_entropy - warp_sum(cross) + mass * log_sum, log_sum - warp_sum(logit), 0};
  float along = 0;
#pragma unroll
  for (int g = 0; g < kGroups; ++g) {
    const int c = lane_channel(g);
    row.direction[g] = 0;
    row.value[g] = 0;
    if (c >= set.channels) continue;
    q[g] *= inverse;
    row.value[g] = logit_gradient(q[g], t[g], mass, soft, hard, c == px.top ? hard : 0.0f);
    row.direction[g] = bounded_logit_error(q[g], t[g], set.count(c));
    along += q[g] * row.direction[g];
  }
  if (!bounded) return loss;
  along = warp_sum(along);
#pragma unroll
  for (int g = 0; g < kGroups; ++g) row.direction[g] = bounded_logit_direction(q[g], row.direction[g], along, omega);
  return loss;
}

}  // namespace aligngs::cuda
