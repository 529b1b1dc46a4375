#include "engine/cuda/map_losses.h"

#include "device/launch.h"
#include "engine/cuda/map_gradients.cuh"
#include "engine/cuda/map_terms.cuh"
#include "engine/cuda/photometric.h"

namespace aligngs::cuda {
namespace {

void geometry_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out) {
  const DeviceContext& context = arena.context();
  const size_t pixels = size_t(in.maps.width) * in.maps.height;
  const MapTermInputs terms{in.maps, in.view, in.settings};
  const MapTermScratch scratch{
      arena.take<float>(pixels, "plane depth"),       arena.take<uint8_t>(pixels, "depth validity"),
      arena.take<uint8_t>(pixels, "depth stencils"),  arena.take<float4>(pixels, "gradients of depth normals"),
      arena.take<MeasuredTerms>(1, "measured terms"), arena.take<ComparedTerms>(1, "compared terms")};
  const LaunchShape shape = one_per_item(pixels, kPixelThreads), one{dim3(1), dim3(kSumThreads), 0};
  const DeviceSpan<double> measured = arena.take<double>(shape.grid.x * size_t(kMeasuredSums), "sums of the losses");
  const DeviceSpan<double> compared = arena.take<double>(shape.grid.x * size_t(kComparedSums), "sums of the losses");
  launch(context, "measure", measure_kernel, shape, terms, scratch, measured);
  launch(context, "finish_measure", finish_measure_kernel, one, terms, measured, scratch.measured);
  launch(context, "compare", compare_kernel, shape, terms, scratch, out.gradients.normal, compared);
  launch(context, "finish_compare", finish_compare_kernel, one, terms, compared, scratch, out.terms);
  MultiViewGradients views;
  if (!in.neighbour.empty() && in.settings.has(LossStage::kTwoViews)) {
    views = multi_view_losses(arena, {in.maps, in.view, in.settings, in.neighbour, scratch.depth, scratch.validity},
                              out.terms);
  }
  launch(context, "map_gradient", map_gradient_kernel, shape, terms, scratch, views, out.gradients);
}

}  // namespace

void map_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out) {
  photometric_losses(arena, in, out);
  if (in.settings.has_geometry_terms(!in.neighbour.empty())) geometry_losses(arena, in, out);
}

uint64_t map_loss_scratch_bytes(const LossSettings& settings, size_t pixels) {
  uint64_t bytes = photometric_scratch_bytes(settings, pixels);
  if (settings.has_geometry_terms(true)) {
    bytes += multi_view_bytes(settings, pixels);
    bytes += uint64_t(pixels) * (sizeof(float) + 2 * sizeof(uint8_t) + sizeof(float4));
    // Blocks of kPixelThreads leave one sum each per term.
    bytes += (uint64_t(kMeasuredSums) + uint64_t(kComparedSums)) * (pixels / kPixelThreads + 1) * sizeof(double);
  }
  return bytes;
}

}  // namespace aligngs::cuda
