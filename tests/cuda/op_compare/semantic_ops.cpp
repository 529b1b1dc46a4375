#include "compare_ops.h"
#include "core/half.h"
#include "device/tolerances.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/semantic_visit.h"
#include "engine/cuda/teacher_maps.h"

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

/// Outputs of the visit and the gradients behind it, on the host.
struct VisitResult {
  std::vector<uint8_t> seen, written;
  std::vector<float> row_slots, gradients;
  std::vector<cuda::CouplingMoments> coupling;
  std::vector<double> terms;
};

class SemanticOps {
 public:
  SemanticOps(cuda::DeviceContext& context, const CpuStep& step)
      : context_(context),
        step_(step),
        padded_(static_cast<size_t>(cuda::padded_channels(step.scene.model.semantic_channels))),
        model_(context, step.scene.model),
        teacher_(context, step.scene.training, step.cache),
        rows_(context, step.view.lists.visible.size() * padded_, "rows") {
    cuda::check_semantic_channels(context, step.scene.model.semantic_channels);
    touched_.assign(context, step.view.cpu_gradients.touched, "touched");
    row_inputs_.model = model_.spans();
    row_inputs_.touched = touched_.span();
    row_inputs_.rank = step.view.list_spans().rank;
    row_inputs_.blend = step.scene.request.losses.semantic_blend;
    semantic_rows(context, row_inputs_, rows_.span());
  }

  VisitResult visit(cuda::SemanticVisitMethod method) {
    cuda::TestView& view = step_.view;
    const size_t n = step_.scene.model.size(), visible = view.lists.visible.size(), instances = view.lists.instances();
    DeviceArray<uint8_t> seen(context_, instances, "seen"), written(context_, n, "written");
    DeviceArray<float> row_slots(context_, instances * padded_, "row slots"),
        gradients(context_, visible * padded_, "gradients");
    DeviceArray<cuda::CouplingMoments> coupling(context_, instances, "coupling");
    DeviceArray<double> tile_terms(context_, 2 * view.view.tiles(), "terms"), terms(context_, 2, "terms");
    DeviceArray<unsigned long long> bad;
    bad.assign(context_, {cuda::kNoBadGradient}, "state");
    const LossSettings& losses = step_.scene.request.losses;
    cuda::SemanticVisitInputs in;
    in.view = view.view_spans();
    in.lists = view.list_spans();
    in.record = view.record_spans();
    in.teacher = teacher_.spans();
    in.rows = rows_.span();
    in.raster = view.raster;
    in.blend = losses.semantic_blend;
    in.coupling = losses.coupling;
    in.couple = true;
    in.soft_weight = losses.weight[Loss::kSemanticSoft];
    in.hard_weight = losses.weight[Loss::kSemanticHard];
    in.sample = losses.semantic_sample;
    in.method = method;
    semantic_visit(context_, in, {row_slots.span(), coupling.span(), seen.span(), tile_terms.span(), terms.span()});
    cuda::SemanticGradientInputs back;
    back.rows = row_inputs_;
    back.lists = view.list_spans();
    back.row_slots = row_slots.span();
    back.seen = seen.span();
    semantic_gradients(context_, back, {gradients.span(), written.span(), bad.span()});
    return {seen.to_host(),      written.to_host(),  row_slots.to_host(),
            gradients.to_host(), coupling.to_host(), terms.to_host()};
  }

  void compare_rows(OpTable& table) {
    const std::vector<uint16_t> got = rows_.to_host();
    std::vector<float> blended, want;
    for_each_touched([&](size_t, size_t rank) {
      for (size_t c = 0; c < step_.channels; ++c) {
        blended.push_back(bfloat16_to_float(got[rank * padded_ + c]));
        want.push_back(step_.features[rank * step_.padded + c]);
      }
    });
    table.compare("semantic_rows", "softmax", blended, want, loose(CudaTolerance().semantic_row));
  }

  void compare_visit(const char* op, cuda::SemanticVisitMethod method, OpTable& table) {
    const VisitResult got = visit(method);
    const CudaTolerance t;
    const auto is_seen = [&](uint64_t slot) { return got.seen[slot] != 0; };
    const auto slot_rows = [&](uint64_t slot) { return &got.row_slots[slot * padded_]; };
    const std::vector<float> sums = sums_of_slots(step_, padded_, slot_rows, is_seen);
    // [written][channels]: ranks leave out what the CPU's arrays do not hold.
    std::vector<float> rows, want_rows, logits, want_logits;
    std::vector<uint8_t> want_written(step_.scene.model.size(), 0);
    for_each_touched([&](size_t i, size_t rank) {
      want_written[i] = step_.written[rank];
      for (size_t c = 0; c < step_.channels && step_.written[rank] != 0 && got.written[i] != 0; ++c) {
        rows.push_back(sums[i * padded_ + c]);
        want_rows.push_back(step_.row_gradients[rank * step_.padded + c]);
        logits.push_back(got.gradients[rank * padded_ + c]);
        want_logits.push_back(step_.logit_gradients[rank * step_.padded + c]);
      }
    });
    table.compare_number(op, "soft loss", got.terms[0], step_.soft, absolute(loose(t.visit_loss)));
    table.compare_number(op, "hard loss", got.terms[1], step_.hard, absolute(loose(t.visit_loss)));
    table.compare(op, "written", got.written, want_written, exact(t.flips));
    table.compare(op, "d rows", rows, want_rows, loose(t.semantic_gradient));
    const auto device_moments = [&](uint64_t slot) { return reinterpret_cast<const float*>(&got.coupling[slot]); };
    const auto cpu_moments = [&](uint64_t slot) { return &step_.slots[slot].coupling_p; };
    const auto cpu_seen = [&](uint64_t slot) { return step_.view.record.seen[slot] != 0; };
    table.compare(op, "coupling moments", sums_of_slots(step_, kMoments, device_moments, is_seen),
                  sums_of_slots(step_, kMoments, cpu_moments, cpu_seen), loose(t.coupling_moment));
    table.compare(op, "d logits", logits, want_logits, loose(t.semantic_gradient));
  }

 private:
  /// body(row of the model, row of what is kept by rank)
  template <class Body>
  void for_each_touched(const Body& body) const {
    for (size_t i = 0; i < step_.scene.model.size(); ++i) {
      if (step_.view.cpu_gradients.touched[i] != 0) body(i, step_.view.lists.rank[i]);
    }
  }

  cuda::DeviceContext& context_;
  const CpuStep& step_;
  size_t padded_;
  cuda::DeviceModel model_;
  cuda::TeacherMaps teacher_;
  DeviceArray<uint8_t> touched_;
  DeviceArray<uint16_t> rows_;
  cuda::SemanticRowInputs row_inputs_;
};

}  // namespace

void compare_semantics(cuda::DeviceContext& context, const CpuStep& step, OpTable& table) {
  if (!step.semantics()) return;
  SemanticOps ops(context, step);
  ops.compare_rows(table);
  ops.compare_visit("visit_compacted", cuda::SemanticVisitMethod::kCompacted, table);
  const cuda::calls::DeviceFacts& facts = context.facts();
  const cuda::VisitDevice device{facts.major, facts.minor, facts.shared_memory_per_block};
  if (semantic_visit_method(cuda::SemanticVisitMethod::kDense, device, step.scene.model.semantic_channels) ==
      cuda::SemanticVisitMethod::kDense) {  // else it does not fit
    ops.compare_visit("visit_dense", cuda::SemanticVisitMethod::kDense, table);
  }
}

}  // namespace aligngs::op_compare
