#include "compare_ops.h"
#include "core/half.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/semantic_visit.h"
#include "engine/cuda/teacher_maps.h"
#include "engine/cuda/tolerances.h"

namespace aligngs::op_compare {
namespace {

using cuda::CudaTolerance;
using cuda::DeviceArray;

constexpr size_t kMoments = 6;  ///< of the coupling, the first six floats of CouplingMoments

/// Adds the slots of a row up, `width` floats each, where seen.
template <class SlotFloats, class Seen>
std::vector<float> sums_of_slots(const CpuStep& step, size_t width, const SlotFloats& floats_of, const Seen& seen) {
  const auto& begin = step.view.lists.slot_begin;
  std::vector<float> out(step.scene.model.size() * width, 0.0f);
  for (size_t i = 0; i < step.scene.model.size(); ++i) {
    for (uint64_t slot = begin[i]; slot < begin[i + 1]; ++slot) {
      if (!seen(slot)) continue;
      const float* from = floats_of(slot);
      for (size_t k = 0; k < width; ++k) out[width * i + k] += from[k];
    }
  }
  return out;
}

}  // namespace

void compare_semantics(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  if (!step.semantics()) return;
  const CompareScene& scene = step.scene;
  cuda::TestView& view = step.view;
  const size_t n = scene.model.size(), visible = view.lists.visible.size(), instances = view.lists.instances(),
               padded = static_cast<size_t>(cuda::padded_channels(scene.model.semantic_channels)),
               channels = step.channels;
  cuda::check_semantic_channels(context, scene.model.semantic_channels);
  cuda::DeviceModel model(context, scene.model);
  const cuda::TeacherMaps teacher(context, scene.training, step.cache);
  DeviceArray<uint8_t> touched, seen(context, instances, "seen"), written(context, n, "written");
  DeviceArray<uint16_t> rows(context, visible * padded, "rows");
  DeviceArray<float> row_slots(context, instances * padded, "row slots"),
      gradients(context, visible * padded, "gradients");
  DeviceArray<cuda::CouplingMoments> coupling(context, instances, "coupling");
  DeviceArray<double> tile_terms(context, 2 * view.view.tiles(), "terms"), terms(context, 2, "terms");
  DeviceArray<unsigned long long> bad;
  touched.assign(context, view.cpu_gradients.touched, "touched");
  bad.assign(context, {cuda::kNoBadGradient}, "state");

  cuda::SemanticRowInputs row_inputs;
  row_inputs.model = model.spans();
  row_inputs.touched = touched.span();
  row_inputs.rank = view.list_spans().rank;
  semantic_rows(context, row_inputs, rows.span());

  const LossSettings& losses = scene.request.losses;
  cuda::SemanticVisitInputs in;
  in.view = view.view_spans();
  in.lists = view.list_spans();
  in.record = view.record_spans();
  in.teacher = teacher.spans();
  in.rows = rows.span();
  in.raster = view.raster;
  in.blend = losses.semantic_blend;
  in.coupling = losses.coupling;
  in.couple = true;
  in.soft_weight = losses.semantic_soft_weight;
  in.hard_weight = losses.semantic_hard_weight;
  in.sample = losses.semantic_sample;
  semantic_visit(context, in, {row_slots.span(), coupling.span(), seen.span(), tile_terms.span(), terms.span()});
  cuda::SemanticGradientInputs back;
  back.rows = row_inputs;
  back.lists = view.list_spans();
  back.row_slots = row_slots.span();
  back.seen = seen.span();
  semantic_gradients(context, back, {gradients.span(), written.span(), bad.span()});

  const CudaTolerance t;
  const std::vector<uint16_t> got_rows = rows.to_host();
  const std::vector<uint8_t> got_seen = seen.to_host(), got_written = written.to_host();
  const std::vector<float> got_slots = row_slots.to_host(), got_gradients = gradients.to_host();
  const std::vector<cuda::CouplingMoments> got_moments = coupling.to_host();
  const std::vector<double> got_terms = terms.to_host();

  // [touched][channels], [written][channels]: ranks leave out what the CPU's arrays do not hold.
  std::vector<float> blended, want_blended, rows_got, rows_want, logits, want_logits;
  std::vector<uint8_t> want_written(n, 0);
  const std::vector<float> sums =
      sums_of_slots(step, padded, [&](uint64_t slot) { return &got_slots[slot * padded]; },
                    [&](uint64_t slot) { return got_seen[slot] != 0; });
  for (size_t i = 0; i < n; ++i) {
    if (view.cpu_gradients.touched[i] == 0) continue;
    const size_t rank = view.lists.rank[i];
    want_written[i] = step.written[rank];
    for (size_t c = 0; c < channels; ++c) {
      blended.push_back(bfloat16_to_float(got_rows[rank * padded + c]));
      want_blended.push_back(step.features[rank * step.padded + c]);
      if (step.written[rank] == 0 || got_written[i] == 0) continue;
      rows_got.push_back(sums[i * padded + c]);
      rows_want.push_back(step.row_gradients[rank * step.padded + c]);
      logits.push_back(got_gradients[rank * padded + c]);
      want_logits.push_back(step.logit_gradients[rank * step.padded + c]);
    }
  }
  table.compare("semantic_rows", "softmax", blended, want_blended, loose(t.semantic_row));
  table.compare_number("semantic_visit", "soft loss", got_terms[0], step.soft, absolute(loose(t.visit_loss)));
  table.compare_number("semantic_visit", "hard loss", got_terms[1], step.hard, absolute(loose(t.visit_loss)));
  table.compare("semantic_visit", "written", got_written, want_written, exact(t.flips));
  table.compare("semantic_visit", "d rows", rows_got, rows_want, loose(t.semantic_gradient));
  const auto on_device = sums_of_slots(
      step, kMoments, [&](uint64_t slot) { return reinterpret_cast<const float*>(&got_moments[slot]); },
      [&](uint64_t slot) { return got_seen[slot] != 0; });
  const auto on_cpu = sums_of_slots(
      step, kMoments, [&](uint64_t slot) { return &step.slots[slot].coupling_p; },
      [&](uint64_t slot) { return view.record.seen[slot] != 0; });
  table.compare("semantic_visit", "coupling moments", on_device, on_cpu, loose(t.coupling_moment));
  table.compare("semantic_gradients", "d logits", logits, want_logits, loose(t.semantic_gradient));
}

}  // namespace aligngs::op_compare
