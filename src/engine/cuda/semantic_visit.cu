#include "engine/cuda/semantic_visit.h"

#include <type_traits>

#include "core/error.h"
#include "device/constants.h"
#include "engine/cuda/semantic_visit.cuh"
#include "engine/cuda/sum_columns.cuh"

namespace aligngs::cuda {
namespace {

/// Channels / 32 of a dense visit at most: P of more would not fit into any device's shared memory.
constexpr int kDenseGroups = 5;

using VisitKernel = void (*)(SemanticVisitInputs, SemanticVisitOutputs, int);

template <class Form>
VisitKernel kernel_for(int padded) {
  const int groups = (padded + kWarp - 1) / kWarp;
  if (groups <= 1) return semantic_visit_kernel<Form, 1>;
  if (groups <= 2) return semantic_visit_kernel<Form, 2>;
  if (groups <= 3) return semantic_visit_kernel<Form, 3>;
  if constexpr (std::is_same_v<Form, DenseVisit>) {
    return semantic_visit_kernel<Form, kDenseGroups>;
  } else {
    if (groups <= 5) return semantic_visit_kernel<Form, 5>;
    return semantic_visit_kernel<Form, 8>;
  }
}

template <class Form>
void launch_visit(const DeviceContext& context, const SemanticVisitInputs& in, const SemanticVisitOutputs& out,
                  unsigned tiles) {
  const int padded = padded_channels(in.teacher.channels);
  launch(context, "semantic_visit", kernel_for<Form>(padded),
         {dim3(tiles), dim3(Form::kThreads), VisitLayout<Form>{padded}.bytes()}, in, out, padded);
}

VisitDevice device_of(const DeviceContext& context) {
  const calls::DeviceFacts& facts = context.facts();
  return {facts.major, facts.minor, facts.shared_memory_per_block};
}

}  // namespace

SemanticVisitMethod semantic_visit_method(SemanticVisitMethod wanted, const VisitDevice& device, int channels) {
  const bool hbm = (device.compute_major == 8 && device.compute_minor == 0) || device.compute_major == 9 ||
                   device.compute_major == 10;
  if (wanted == SemanticVisitMethod::kAutomatic) {
    wanted = hbm ? SemanticVisitMethod::kDense : SemanticVisitMethod::kCompacted;
  }
  const int padded = padded_channels(channels);
  const bool fits = padded <= kDenseGroups * kWarp && VisitLayout<DenseVisit>{padded}.bytes() <= device.shared_bytes;
  return fits ? wanted : SemanticVisitMethod::kCompacted;
}

void check_semantic_channels(const DeviceContext& context, int channels) {
  const VisitLayout<CompactedVisit> layout{padded_channels(channels)};
  if (channels <= kMaxSemanticChannels && layout.bytes() <= context.facts().shared_memory_per_block) return;
  throw_resources({}, std::to_string(channels) + " semantic channels are more than this device holds at a time",
                  "train fewer classes: keep the limit on active classes on, or train on the CPU (--device cpu)");
}

void semantic_visit(const DeviceContext& context, const SemanticVisitInputs& in, const SemanticVisitOutputs& out) {
  fill_zero(context, out.seen);
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  if (semantic_visit_method(in.method, device_of(context), in.teacher.channels) == SemanticVisitMethod::kDense) {
    launch_visit<DenseVisit>(context, in, out, tiles);
  } else {
    launch_visit<CompactedVisit>(context, in, out, tiles);
  }
  sum_columns<kSemanticTerms>(context, out.tile_terms.part(0, kSemanticTerms * size_t(tiles)),
                              static_cast<double>(in.sample.scale()) / static_cast<double>(in.teacher.valid),
                              out.terms);
}

}  // namespace aligngs::cuda
