#include <algorithm>

#include "compare_ops.h"
#include "core/random.h"
#include "device/tolerances.h"
#include "engine/cpu/optimiser.h"
#include "engine/cpu/pose_gradient.h"
#include "engine/cuda/density.h"
#include "engine/cuda/optimiser.h"
#include "engine/cuda/pose_gradient.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/cuda/shape_terms.h"
#include "engine/engine_arrays.h"

namespace aligngs::op_compare {
namespace {

using cuda::CudaTolerance;
using cuda::DeviceArray;

template <class Array>
std::vector<float> vector_of(const Array& a) {
  return {a.data(), a.data() + a.size()};
}

/// The CPU's gradients in the shape of a model; rows of sh that are not touched are zero.
GaussianModel as_model(const CpuStep& step, const cpu::ParameterGradients& g) {
  GaussianModel m = step.scene.model;
  m.positions = vector_of(g.positions);
  m.log_scales = vector_of(g.log_scales);
  m.rotations = vector_of(g.rotations);
  m.opacity_logits = vector_of(g.opacity_logits);
  constexpr size_t kShRow = size_t(3) * kShCoefficients;
  for (size_t i = 0; i < m.sh.size(); ++i) m.sh[i] = g.touched[i / kShRow] != 0 ? g.sh[i] : 0.0f;
  return m;
}

void compare_shape_terms(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  cuda::DeviceModel model(context, step.scene.model), gradients(context, as_model(step, step.parameters));
  DeviceArray<uint8_t> touched;
  DeviceArray<uint32_t> visible;
  DeviceArray<LossTerms> terms;
  DeviceArray<unsigned long long> bad;
  touched.assign(context, step.parameters.touched, "touched");
  visible.assign(context, {static_cast<uint32_t>(step.view.visible)}, "visible");
  terms.assign(context, {LossTerms()}, "losses");
  bad.assign(context, {cuda::kNoBadGradient}, "state");
  cuda::DeviceArena arena(context);
  const StepRequest& request = step.scene.request;
  add_shape_terms(arena, {model.spans(), touched.span(), visible.span(), request.losses, request.extent},
                  {gradients.spans(), terms.span(), bad.span()});
  const LossTerms got = terms.to_host()[0];
  const CudaTolerance t;
  for (const Loss loss : losses_of(LossStage::kShape)) {
    table.compare_number("shape_terms", row_of(loss).name.data(), got[loss], step.shape_terms[loss],
                         absolute(tight(t.loss)));
  }
  table.compare("shape_terms", "d log scales", gradients.log_scales.to_host(), step.with_shape.log_scales,
                tight(t.gradient));
  table.compare("shape_terms", "d opacity logits", gradients.opacity_logits.to_host(), step.with_shape.opacity_logits,
                tight(t.gradient));
}

void compare_pose_gradient(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  cuda::DeviceModel model(context, step.scene.model), gradients(context, as_model(step, step.parameters));
  DeviceArray<uint8_t> touched;
  DeviceArray<PoseGradient<double>> out;
  touched.assign(context, step.parameters.touched, "touched");
  out.assign(context, {PoseGradient<double>()}, "pose");
  cuda::DeviceArena arena(context);
  const Camera& camera = step.scene.training.data.camera;
  const int degree = step.scene.request.sh_degree;
  cuda::pose_gradient(arena, {model.spans(), gradients.spans(), touched.span(), pose_frame<float>(camera), degree},
                      out.span());
  const PoseGradient<double> got = out.to_host()[0];
  ThreadPool pool(1);
  const PoseGradient<double> want = cpu::pose_gradient(step.scene.model, step.parameters, camera, degree, pool);
  const auto vector = [](const Vec3d& v) { return std::vector<double>{v.x, v.y, v.z}; };
  table.compare("pose_gradient", "rotation", vector(got.rotation), vector(want.rotation),
                tight(CudaTolerance().pose_sum));
  table.compare("pose_gradient", "translation", vector(got.translation), vector(want.translation),
                tight(CudaTolerance().pose_sum));
}

void compare_density(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  const size_t n = step.scene.model.size();
  std::vector<DensitySums> sums(n);
  for (size_t i = 0; i < n; ++i) {
    if (step.parameters.touched[i] != 0) sums[i] = step.parameters.density[i];
  }
  DeviceArray<DensitySums> device_sums;
  device_sums.assign(context, sums, "density sums");
  DeviceArray<uint8_t> touched;
  touched.assign(context, step.parameters.touched, "touched");
  DensityStatistics want = step.statistics;
  const std::vector<NamedArray> arrays = arrays_of(want);
  std::vector<DeviceArray<float>> got(arrays.size());
  for (DeviceArray<float>& a : got) a.assign(context, std::vector<float>(n, 0.0f), "statistics");
  add_density_statistics(
      context, {step.view.view_spans(), touched.span(), device_sums.span(), {}},
      {got[0].span(), got[1].span(), got[2].span(), got[3].span(), got[4].span(), got[5].span(), got[6].span()});
  for (size_t k = 0; k < arrays.size(); ++k) {
    table.compare("density", arrays[k].name, got[k].to_host(), *arrays[k].values, tight(CudaTolerance().statistic));
  }
}

constexpr int64_t kStep = 17;  ///< of the optimiser, which corrects a bias by it

/// Moments as after some steps: not zero, and the second ones not so small that Adam divides rounding by rounding.
AdamMoments some_moments(const GaussianModel& like) {
  Random random(5);
  AdamMoments moments;
  moments.reset(like);
  for (const NamedArray& a : arrays_of(moments.m)) {
    for (float& x : *a.values) x = static_cast<float>(random.uniform(-0.01, 0.01));
  }
  for (const NamedArray& a : arrays_of(moments.v)) {
    for (float& x : *a.values) x = static_cast<float>(random.uniform(1e-6, 1e-4));
  }
  for (size_t i = 0; i < like.size(); ++i) moments.semantic_updates[i] = static_cast<float>(i % kStep);
  moments.sh_used = size_t(3) * kShCoefficients;
  return moments;
}

void compare_optimiser(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  const AdamMoments start = some_moments(step.scene.model);
  StepRequest request = step.scene.request;
  request.step = kStep;
  request.limits = {0.3f, 4.0f, 2.0f};  // all three act on some rows
  const bool semantics = step.semantics();
  const size_t n = step.scene.model.size(), padded = step.padded;

  GaussianModel want = step.scene.model;
  AdamMoments want_moments = start;
  cpu::AlignedArray<float> rows;
  rows.resize(step.logit_gradients.size());
  std::copy(step.logit_gradients.begin(), step.logit_gradients.end(), rows.data());
  cpu::SemanticGradients semantic;
  if (semantics) semantic = {step.view.lists.rank.data(), step.written.data(), rows.data(), false, nullptr, 0, nullptr};
  cpu::optimise(request, step.with_shape, semantic, step.view.view, step.view.pool, want, want_moments);

  cuda::DeviceModel model(context, step.scene.model), m(context, start.m), v(context, start.v),
      gradients(context, as_model(step, step.with_shape));
  std::vector<uint8_t> written(n, 0);
  std::vector<float> logits;
  const size_t device_padded = static_cast<size_t>(cuda::padded_channels(step.scene.model.semantic_channels));
  if (semantics) {
    logits.assign(step.view.lists.visible.size() * device_padded, 0.0f);
    for (size_t i = 0; i < n; ++i) {
      if (step.view.view.rects[i].area() == 0) continue;
      const size_t rank = step.view.lists.rank[i];
      written[i] = step.written[rank];
      std::copy_n(step.logit_gradients.begin() + static_cast<std::ptrdiff_t>(rank * padded), step.channels,
                  logits.begin() + static_cast<std::ptrdiff_t>(rank * device_padded));
    }
  }
  DeviceArray<uint8_t> touched, semantic_written;
  DeviceArray<float> semantic_gradients, updates;
  touched.assign(context, step.with_shape.touched, "touched");
  semantic_written.assign(context, written, "written");
  semantic_gradients.assign(context, logits, "semantic gradients");
  updates.assign(context, start.semantic_updates, "updates of the semantic rows");
  cuda::OptimiserInputs in;
  in.gradients = gradients.spans();
  in.touched = touched.span();
  if (semantics) {
    in.semantic_gradients = semantic_gradients.span();
    in.semantic_written = semantic_written.span();
    in.rank = step.view.list_spans().rank;
  }
  optimise(context, request, in, {model.spans(), m.spans(), v.spans(), updates.span()}, start.sh_used);

  const auto compare = [&](const char* what, cuda::DeviceModel& got, GaussianModel& expected) {
    const std::vector<float> arrays[] = {got.positions.to_host(), got.log_scales.to_host(),
                                         got.rotations.to_host(), got.opacity_logits.to_host(),
                                         got.sh.to_host(),        got.semantics.to_host()};
    size_t k = 0;
    for (const NamedArray& a : arrays_of(expected)) {
      table.compare("optimiser", std::string(what) + a.name, arrays[k++], *a.values, tight(CudaTolerance().parameter));
    }
  };
  compare("", model, want);
  compare("m ", m, want_moments.m);
  compare("v ", v, want_moments.v);
  table.compare("optimiser", "updates of semantics", updates.to_host(), want_moments.semantic_updates, exact());
}

}  // namespace

void compare_updates(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  compare_shape_terms(context, step, table);
  compare_pose_gradient(context, step, table);
  compare_density(context, step, table);
  compare_optimiser(context, step, table);
}

}  // namespace aligngs::op_compare
