#include <cmath>
#include <limits>

#include "compare_ops.h"
#include "device/tolerances.h"
#include "engine/cuda/blend_backward.h"
#include "engine/cuda/blend_forward.h"
#include "engine/cuda/device_frame.h"
#include "engine/cuda/map_losses.h"
#include "engine/cuda/parameter_gradients.h"

namespace aligngs::op_compare {
namespace {

using cuda::CudaTolerance;
using cuda::DeviceArray;

void compare_map_losses(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  const RenderMaps<float>& maps = step.view.maps;
  const size_t n = maps.pixels();
  DeviceArray<float> color, alpha, normal, distance, expected;
  color.assign(context, maps.color, "maps");
  alpha.assign(context, maps.alpha, "maps");
  normal.assign(context, maps.normal, "maps");
  distance.assign(context, maps.distance, "maps");
  expected.assign(context, maps.expected, "maps");
  DeviceArray<float> d_color(context, 3 * n, "gradients"), d_normal(context, 3 * n, "gradients"),
      d_distance(context, n, "gradients"), residual(context, n, "residual");
  DeviceArray<LossTerms> terms(context, 1, "losses");
  const cuda::TrainingMaps training(context, step.scene.training);
  cuda::DeviceArena arena(context);
  const cuda::MapLossSpans in{
      {maps.width, maps.height, color.span(), normal.span(), alpha.span(), distance.span(), expected.span(), {}},
      training.spans(),
      step.scene.request.losses};
  map_losses(arena, in, {{d_color.span(), d_normal.span(), d_distance.span(), {}}, residual.span(), terms.span()});
  const LossTerms got = terms.to_host()[0];
  const CudaTolerance t;
  for (const Loss loss : losses_of(LossStage::kColor, LossStage::kGeometry)) {
    table.compare_number("map_losses", row_of(loss).name.data(), got[loss], step.map_terms[loss],
                         absolute(tight(t.loss)));
  }
  table.compare_number("map_losses", "psnr", got.psnr, step.map_terms.psnr, absolute(tight(t.psnr)));
  table.compare("map_losses", "d colour", d_color.to_host(), step.gradients.color, tight(t.gradient));
  table.compare("map_losses", "d normal", d_normal.to_host(), step.gradients.normal, tight(t.gradient));
  table.compare("map_losses", "d distance", d_distance.to_host(), step.gradients.distance, tight(t.gradient));
  table.compare("map_losses", "residual", residual.to_host(), step.residual, tight(t.map));
}

std::vector<SplatGradient> run_blend_backward(cuda::DeviceContext& context, const CpuStep& step,
                                              cuda::BlendBackwardMethod method) {
  DeviceArray<float> color, normal, distance, alpha, residual, prior;
  color.assign(context, step.gradients.color, "gradients");
  normal.assign(context, step.gradients.normal, "gradients");
  distance.assign(context, step.gradients.distance, "gradients");
  alpha.assign(context, step.gradients.alpha, "gradients");
  residual.assign(context, step.residual, "residual");
  prior.assign(context, step.scene.training.data.prior_depth.data, "prior");
  DeviceArray<SplatGradient> slots(context, step.view.lists.instances(), "slots");
  cuda::TestView& view = step.view;
  cuda::DeviceArena arena(context);
  cuda::DeviceFrame frame =
      take_frame(arena, step.scene.training.data.camera, view.raster, step.scene.model.size(), true);
  cuda::BlendBackwardInputs in;
  in.view = view.view_spans();
  in.lists = view.list_spans();
  in.record = view.record_spans();
  if (method == cuda::BlendBackwardMethod::kPerSplat) {
    frame.lists = view.list_spans();
    take_checkpoints(arena, true, frame);  // which the CPU engine does not leave
    blend_forward(context, {in.view, in.lists, view.raster, true}, frame.maps, frame.record);
    in.record.checkpoints = frame.record.checkpoints;
    in.record.plane_checkpoints = frame.record.plane_checkpoints;
    in.maps = frame.maps;
  }
  in.gradients = {color.span(), normal.span(), distance.span(), alpha.span()};
  in.residual = residual.span();
  in.prior = prior.span();
  in.prior_scale = step.scene.request.losses.prior_depth_scale;
  in.raster = view.raster;
  in.geometry = in.density = true;
  in.method = method;
  blend_backward(context, in, slots.span());
  return slots.to_host();
}

void compare_blend_backward(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  const struct {
    const char* name;
    size_t first, count;
  } fields[] = {{"colour", kSumColor, 3},
                {"weight", kSumWeight, 1},
                {"normal", kSumNormal, 3},
                {"distance", kSumDistance, 1},
                {"moments", kSumP, 6},
                {"residual", kSumResidual, 1},
                {"unsupported", kSumUnsupported, 1},
                {"photometric", kSumPhotometricP, 2},
                {"absolute", kSumPhotometricAbsP, 2}};
  const auto seen = [&](size_t slot) { return step.view.record.seen[slot] != 0; };
  for (const auto method : {cuda::BlendBackwardMethod::kPerPixel, cuda::BlendBackwardMethod::kPerSplat}) {
    const std::vector<SplatGradient> got = run_blend_backward(context, step, method);
    const char* op = method == cuda::BlendBackwardMethod::kPerPixel ? "backward_per_pixel" : "backward_per_splat";
    for (const auto& f : fields) {
      table.compare(op, f.name, fields_of(got, got.size(), f.first, f.count, seen),
                    fields_of(step.slots, got.size(), f.first, f.count, seen), tight(CudaTolerance().slot_sum));
    }
  }
}

void compare_parameter_gradients(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  cuda::TestView& view = step.view;
  const size_t n = step.scene.model.size(), instances = step.view.lists.instances();
  std::vector<SplatGradient> main(instances);
  std::vector<cuda::CouplingMoments> moments(instances);
  for (size_t i = 0; i < instances; ++i) {
    const cpu::CoupledSplatGradient& s = step.slots[i];
    main[i] = s.maps;
    moments[i] = {s.coupling_p, s.coupling_r, s.coupling_one, s.coupling_pp, s.coupling_pr, s.coupling_rr, {0, 0}};
  }
  cuda::DeviceModel model(context, step.scene.model), out(context, step.scene.model);
  DeviceArray<SplatGradient> slots;
  DeviceArray<cuda::CouplingMoments> coupling;
  DeviceArray<uint8_t> touched(context, n, "touched");
  DeviceArray<uint32_t> visible(context, 1, "visible");
  DeviceArray<DensitySums> density(context, n, "density");
  DeviceArray<double> squares(context, 2, "squares"), scratch(context, cuda::square_scratch(n), "scratch");
  DeviceArray<unsigned long long> bad;
  slots.assign(context, main, "slots");
  coupling.assign(context, moments, "coupling");
  bad.assign(context, {cuda::kNoBadGradient}, "state");
  mark_touched(context, view.list_spans(), view.record_spans(), touched.span(), visible.span());
  cuda::ParameterGradientSpans in;
  in.model = model.spans();
  in.view = view.view_spans();
  in.lists = view.list_spans();
  in.record = view.record_spans();
  in.touched = touched.span();
  in.slots = slots.span();
  if (step.semantics()) in.coupling = coupling.span();
  in.coupling_seen = view.record_spans().seen;
  in.coupling_scale = step.semantics() ? step.coupling_scale : 0.0f;
  in.sh_degree = step.scene.request.sh_degree;
  parameter_gradients(context, in, {out.spans(), density.span(), squares.span(), scratch.span(), bad.span()});

  const cpu::ParameterGradients& want = step.parameters;
  const std::vector<uint8_t> got_touched = touched.to_host();
  const Limit limit = tight(CudaTolerance().row_gradient);
  const auto is_touched = [&](size_t i) { return want.touched[i] != 0; };
  const auto rows_of = [&](const auto& numbers, size_t width) {
    std::vector<float> rows;
    for (size_t i = 0; i < n * width; ++i) {
      if (is_touched(i / width)) rows.push_back(numbers[i]);
    }
    return rows;
  };
  const char* op = "parameter_gradients";
  table.compare(op, "touched", got_touched, want.touched, exact());
  table.compare_number(op, "visible", visible.to_host()[0], static_cast<double>(step.view.visible), exact());
  table.compare(op, "d positions", out.positions.to_host(), want.positions, limit);
  table.compare(op, "d log scales", out.log_scales.to_host(), want.log_scales, limit);
  table.compare(op, "d rotations", out.rotations.to_host(), want.rotations, limit);
  table.compare(op, "d opacity logits", out.opacity_logits.to_host(), want.opacity_logits, limit);
  constexpr size_t kShRow = size_t(3) * kShCoefficients;
  table.compare(op, "d sh", rows_of(out.sh.to_host(), kShRow), rows_of(want.sh, kShRow), limit);
  constexpr size_t kDensityFloats = sizeof(DensitySums) / sizeof(float);
  table.compare(op, "density sums", fields_of(density.to_host(), n, 0, kDensityFloats, is_touched),
                fields_of(want.density, n, 0, kDensityFloats, is_touched), limit);
  const double rows = static_cast<double>(std::max<size_t>(1, step.view.visible));
  const std::vector<double> sums = squares.to_host();
  const Limit rms = tight(CudaTolerance().gradient_rms);
  table.compare_number(op, "photometric RMS", std::sqrt(sums[0] / rows), step.totals.photometric_rms, rms);
  if (step.semantics()) {
    table.compare_number(op, "coupling RMS", std::sqrt(sums[1] / rows), step.totals.coupling_rms, rms);
  }
}

}  // namespace

void compare_backward(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  compare_map_losses(context, step, table);
  compare_blend_backward(context, step, table);
  compare_parameter_gradients(context, step, table);
}

}  // namespace aligngs::op_compare
