// Kernels of optimiser.h.
#include "engine/cuda/optimiser.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/formulas/adam.h"
#include "engine/formulas/position_noise.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs::cuda {

inline constexpr int kShRow = 3 * kShCoefficients;
inline constexpr int kVector = 4;  ///< floats of one access
static_assert(kShRow % kVector == 0, "rows of spherical harmonics are whole vectors");

struct ShapeSteps {
  AdamStep<float> position, scale, rotation, opacity;
};
struct ShSteps {
  AdamStep<float> dc, rest;
};

__device__ __forceinline__ bool is_blocked(const OptimiserInputs& in) {
  return !in.blocked.empty() && in.blocked[0] != 0;
}

/// `count` numbers of row i.
template <int kCount>
__device__ __forceinline__ void update_row(const AdamStep<float>& step, size_t i, DeviceSpan<float> gradients,
                                           DeviceSpan<float> parameters, DeviceSpan<float> m, DeviceSpan<float> v) {
#pragma unroll
  for (int k = 0; k < kCount; ++k) {
    const size_t j = kCount * i + k;
    adam_update(step, gradients[j], parameters[j], m[j], v[j]);
  }
}

/// A thread per row: everything but colours and semantics, and the limits on shape.
__global__ void __launch_bounds__(kRowThreads)
    adam_shapes_kernel(OptimiserInputs in, OptimiserState s, ShapeSteps steps, ShapeLimits limits) {
  const size_t i = item_index();
  if (i >= s.model.gaussians || is_blocked(in)) return;
  update_row<3>(steps.position, i, in.gradients.positions, s.model.positions, s.m.positions, s.v.positions);
  update_row<4>(steps.rotation, i, in.gradients.rotations, s.model.rotations, s.m.rotations, s.v.rotations);
  update_row<1>(steps.opacity, i, in.gradients.opacity_logits, s.model.opacity_logits, s.m.opacity_logits,
                s.v.opacity_logits);
  update_row<3>(steps.scale, i, in.gradients.log_scales, s.model.log_scales, s.m.log_scales, s.v.log_scales);
  if (limits.flat_ratio_max > 0 || limits.aspect_max > 0 || limits.scale_max > 0) {
    float* scales = &s.model.log_scales[3 * i];
    Vec3<float> log_scale{scales[0], scales[1], scales[2]};
    apply_shape_limits(limits, log_scale);
    for (int k = 0; k < 3; ++k) scales[k] = log_scale[k];
  }
}

/// A thread per four numbers of the first `used` of each row.
__global__ void __launch_bounds__(kRowThreads)
    adam_sh_kernel(OptimiserInputs in, OptimiserState s, ShSteps steps, unsigned vectors) {
  const size_t item = item_index(), row = item / vectors;
  if (row >= s.model.gaussians || is_blocked(in)) return;
  const int first = static_cast<int>(item % vectors) * kVector;
  const size_t at = kShRow * row + static_cast<size_t>(first);
  const bool touched = in.touched[row] != 0;
  float4 p = *reinterpret_cast<float4*>(&s.model.sh[at]), m = *reinterpret_cast<float4*>(&s.m.sh[at]),
         v = *reinterpret_cast<float4*>(&s.v.sh[at]);
  const float4 g = touched ? *reinterpret_cast<const float4*>(&in.gradients.sh[at]) : make_float4(0, 0, 0, 0);
  const AdamStep<float>& low = first == 0 ? steps.dc : steps.rest;  // the first three numbers have their own rate
  adam_update(low, g.x, p.x, m.x, v.x);
  adam_update(low, g.y, p.y, m.y, v.y);
  adam_update(low, g.z, p.z, m.z, v.z);
  adam_update(steps.rest, g.w, p.w, m.w, v.w);
  *reinterpret_cast<float4*>(&s.model.sh[at]) = p;
  *reinterpret_cast<float4*>(&s.m.sh[at]) = m;
  *reinterpret_cast<float4*>(&s.v.sh[at]) = v;
}

/// A warp per row.
__global__ void __launch_bounds__(kRowThreads)
    adam_semantics_kernel(OptimiserInputs in, OptimiserState s, AdamRowSteps steps, bool skip_invisible) {
  const size_t row = item_index() / 32;
  if (row >= s.model.gaussians || is_blocked(in)) return;
  const bool written = !in.semantic_gradients.empty() && in.semantic_written[row] != 0;
  if (!written && skip_invisible) return;
  const float count = s.semantic_updates[row] + 1;
  const AdamStep<float> step = steps.at(count);
  __syncwarp();  // every lane has read it
  if (lane_index() == 0) s.semantic_updates[row] = count;
  const int channels = s.model.channels;
  const size_t from = written ? size_t(in.rank[row]) * static_cast<size_t>(padded_channels(channels)) : 0;
  for (int c = static_cast<int>(lane_index()); c < channels; c += 32) {
    const size_t at = row * static_cast<size_t>(channels) + static_cast<size_t>(c);
    const float g = written ? in.semantic_gradients[from + static_cast<size_t>(c)] : 0.0f;
    adam_update(step, g, s.model.semantics[at], s.m.semantics[at], s.v.semantics[at]);
  }
}

__global__ void __launch_bounds__(kRowThreads) cap_opacities_kernel(OptimiserState s, float logit) {
  const size_t i = item_index();
  if (i >= s.model.gaussians) return;
  const float x = s.model.opacity_logits[i];
  s.model.opacity_logits[i] = logit < x ? logit : x;
  s.m.opacity_logits[i] = 0;
  s.v.opacity_logits[i] = 0;
}

__global__ void __launch_bounds__(kRowThreads) position_noise_kernel(PositionNoise noise, ModelSpans model) {
  const size_t i = item_index();
  if (i >= model.gaussians) return;
  const float opacity = 1.0f / (1.0f + std::exp(-model.opacity_logits[i]));
  const Vec3<float> shift = position_noise(noise, i, opacity, &model.log_scales[3 * i], &model.rotations[4 * i]);
  for (int k = 0; k < 3; ++k) model.positions[3 * i + k] += shift[k];
}

__global__ void __launch_bounds__(kRowThreads)
    raise_scales_kernel(DeviceSpan<const float> log_floors, ModelSpans model) {
  const size_t i = item_index();
  if (i >= model.gaussians) return;
  float* s = &model.log_scales[3 * i];
  Vec3<float> scale{s[0], s[1], s[2]};
  raise_larger_scales(log_floors[i], scale);
  for (int k = 0; k < 3; ++k) s[k] = scale[k];
}

__global__ void __launch_bounds__(kRowThreads)
    bad_parameter_kernel(DeviceSpan<const float> values, size_t width, DeviceSpan<unsigned long long> first) {
  const size_t i = item_index();
  if (i >= values.size) return;
  const float x = values[i];
  if (x - x != 0) atomicMin(&first[0], static_cast<unsigned long long>(i / width));
}

void optimise(const DeviceContext& context, const StepRequest& request, const OptimiserInputs& in,
              const OptimiserState& state, size_t sh_used) {
  const auto step_of = [&](float rate) {
    return make_adam_step<float>(request.adam, static_cast<double>(rate), request.step);
  };
  const LearningRates& rates = request.rates;
  const size_t n = state.model.gaussians;
  launch(context, "adam_shapes", adam_shapes_kernel, one_per_item(n, kRowThreads), in, state,
         ShapeSteps{step_of(rates.position), step_of(rates.scale), step_of(rates.rotation), step_of(rates.opacity)},
         request.limits);
  const unsigned vectors = static_cast<unsigned>((std::min(sh_used, size_t(kShRow)) + kVector - 1) / kVector);
  launch(context, "adam_sh", adam_sh_kernel, one_per_item(n * vectors, kRowThreads), in, state,
         ShSteps{step_of(rates.sh_dc), step_of(rates.sh_rest)}, vectors);
  const bool skip = request.adam.skip_invisible_semantics;
  if (state.model.channels > 0 && (!in.semantic_gradients.empty() || !skip)) {
    launch(context, "adam_semantics", adam_semantics_kernel, one_per_item(32 * n, kRowThreads), in, state,
           make_adam_row_steps(request.adam, rates.semantic, request.step), skip);
  }
}

void cap_opacities(const DeviceContext& context, float maximum, const OptimiserState& state) {
  launch(context, "cap_opacities", cap_opacities_kernel, one_per_item(state.model.gaussians, kRowThreads), state,
         std::log(maximum / (1 - maximum)));
}

void add_position_noise(const DeviceContext& context, const PositionNoise& noise, const ModelSpans& model) {
  launch(context, "position_noise", position_noise_kernel, one_per_item(model.gaussians, kRowThreads), noise, model);
}

void raise_scales(const DeviceContext& context, DeviceSpan<const float> log_floors, const ModelSpans& model) {
  launch(context, "raise_scales", raise_scales_kernel, one_per_item(model.gaussians, kRowThreads), log_floors, model);
}

NonFinite find_bad_parameter(DeviceArena& arena, const ModelSpans& model) {
  const struct {
    const char* name;
    DeviceSpan<const float> values;
    size_t width;
  } classes[] = {{"positions", model.positions, 3},
                 {"log_scales", model.log_scales, 3},
                 {"rotations", model.rotations, 4},
                 {"opacity_logits", model.opacity_logits, 1},
                 {"sh", model.sh, kShRow},
                 {"semantics", model.semantics, static_cast<size_t>(std::max(1, model.channels))}};
  const DeviceSpan<unsigned long long> first =
      arena.take<unsigned long long>(std::size(classes), "search for bad parameters");
  arena.context().fill_bytes(first.data, 0xFF, first.size * sizeof(unsigned long long));
  for (size_t k = 0; k < std::size(classes); ++k) {
    launch(arena.context(), "bad_parameter", bad_parameter_kernel, one_per_item(classes[k].values.size, kRowThreads),
           classes[k].values, classes[k].width, first.part(k, 1));
  }
  unsigned long long rows[std::size(classes)];
  download(arena.context(), rows, first);
  for (size_t k = 0; k < std::size(classes); ++k) {
    if (rows[k] != kNoBadGradient) return {true, static_cast<int64_t>(rows[k]), classes[k].name};
  }
  return {};
}

}  // namespace aligngs::cuda
