#include "engine/cuda/optimiser.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/optimiser.cuh"
#include "engine/cuda/parameter_gradients.h"
#include "engine/formulas/adam.h"

namespace aligngs::cuda {

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
