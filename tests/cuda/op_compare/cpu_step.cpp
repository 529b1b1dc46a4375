#include "cpu_step.h"

#include <algorithm>

#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/tile_products.h"
#include "engine/engine_arrays.h"
#include "engine/losses/map_losses.h"

namespace aligngs::op_compare {
namespace {

/// The gradient -t / Q of blended probabilities jumps to 0 at the floor of Q. With the room's logits this close
/// together every Q stays above it, whatever the rounding.
constexpr float kAboveTheFloor = 0.5f;

}  // namespace

CompareScene make_compare_scene(const BenchmarkRoom& room) {
  CompareScene scene{room, benchmark_model(room), benchmark_view(room, 0), benchmark_request()};
  for (float& s : scene.model.semantics) s *= kAboveTheFloor;
  scene.request.rates = {1e-3f, 2.5e-3f, 1e-4f, 2e-2f, 5e-3f, 1e-3f, 5e-3f};
  return scene;
}

CpuStep::CpuStep(cuda::DeviceContext& context, const CompareScene& of)
    : scene(of), view(context, of.model, of.training.data.camera, of.request.raster, of.request.sh_degree) {
  run_losses();
  run_backward();
  run_reduction();
}

void CpuStep::run_losses() {
  const MapLossInputs<float> in{view.maps, scene.training, scene.request.losses, &view.pool};
  gradients.reset(view.maps.pixels());
  map_losses(in, map_terms, gradients);
  color_residual(in, residual);
}

void CpuStep::run_backward() {
  channels = static_cast<size_t>(scene.model.semantic_channels);
  const size_t n = scene.model.size(), visible = view.lists.visible.size();
  cpu::SemanticPass pass;
  if (semantics()) {
    padded = cpu::padded_channels(scene.model.semantic_channels);
    counts = cpu::make_class_counts(scene.model.semantic_channels, 0);
    prepare_semantic_view(scene.training, counts.classes(), view.pool, cache);
    features.resize(visible * padded);
    row_gradients.resize(visible * padded);
    for (size_t i = 0; i < n; ++i) {
      if (view.view.rects[i].area() == 0) continue;
      cpu::softmax_row(&scene.model.semantics[i * channels], channels, padded, counts.last_log_count(),
                       features.data() + view.lists.rank[i] * padded);
    }
    pass.step = {&scene.training, &cache, &scene.request.losses, &counts, scene.model.semantic_channels, padded, true};
    pass.rank = view.lists.rank.data();
    pass.features = features.data();
    pass.gradients = row_gradients.data();
    pass.written = &written;
    pass.visible = visible;
  }
  const ImageF& prior = scene.training.data.prior_depth;
  cpu::RowBatches batches;
  cpu::backward_pass(
      {view.view, view.lists, view.raster}, view.record,
      {gradients, residual.data(), prior.empty() ? nullptr : prior.data.data(), scene.request.losses.prior_depth_scale},
      true, true, semantics() ? &pass : nullptr, view.pool, view.scratch, batches, slots);
  if (!semantics()) return;
  soft = pass.soft;
  hard = pass.hard;
  logit_gradients.assign(visible * padded, 0.0f);
  for (size_t row = 0; row < visible; ++row) {
    if (written[row] == 0) continue;
    softmax_backward(features.data() + row * padded, row_gradients.data() + row * padded, scene.model.semantic_channels,
                     &logit_gradients[row * padded]);
  }
}

cpu::ParameterGradientInputs CpuStep::parameter_gradient_inputs(const StepRequest& request) const {
  return {scene.model, view.view, view.lists,   view.record,
          slots,       request,   view.visible, semantics() ? coupling_scale : 0.0f};
}

void CpuStep::run_reduction() {
  StepRequest plain = scene.request;
  plain.losses.weight[Loss::kFlatten] = plain.losses.weight[Loss::kOpacityL1] = plain.losses.weight[Loss::kScaleL1] = 0;
  LossTerms none;
  cpu::ParameterGradientTotals same;
  parameters.touched = with_shape.touched = view.cpu_gradients.touched;
  cpu::parameter_gradients(parameter_gradient_inputs(plain), view.pool, none, totals, parameters);
  cpu::parameter_gradients(parameter_gradient_inputs(scene.request), view.pool, shape_terms, same, with_shape);
  for (const NamedArray& a : arrays_of(statistics)) a.values->assign(scene.model.size(), 0.0f);
  cpu::add_density_statistics(parameter_gradient_inputs(scene.request), parameters, view.pool, statistics);
}

}  // namespace aligngs::op_compare
