#include "engine/cuda/map_losses.h"

#include "device/launch.h"
#include "engine/cuda/map_gradients.cuh"
#include "engine/cuda/map_terms.cuh"
#include "engine/cuda/photometric.cuh"

namespace aligngs::cuda {
namespace {

void photometric_losses(DeviceArena& arena, const MapLossInputs& in, const MapLossOutputs& out) {
  const DeviceContext& context = arena.context();
  const size_t pixels = size_t(in.maps.width) * in.maps.height;
  const double scale = in.view.counted > 0 ? 1.0 / (3.0 * in.view.counted) : 0.0;
  PhotometricInputs p;
  p.maps = in.maps;
  p.view = in.view;
  p.window = gaussian_window<float>();
  p.ssim = in.settings.weight[Loss::kSsim] != 0;
  p.l1_step = static_cast<float>(in.settings.weight[Loss::kL1] * scale);
  p.ssim_factor = static_cast<float>(-in.settings.weight[Loss::kSsim] * scale);
  const dim3 tiles(static_cast<unsigned>((in.maps.width + kSsimTile - 1) / kSsimTile),
                   static_cast<unsigned>((in.maps.height + kSsimTile - 1) / kSsimTile), 3);
  const size_t blocks = size_t(tiles.x) * tiles.y * tiles.z;
  const DeviceSpan<double> partial = arena.take<double>(kPhotometricSums * blocks, "photometric sums");
  const DeviceSpan<float> derivatives =
      arena.take<float>(p.ssim ? 3 * kSsimGradients * pixels : 0, "derivatives of SSIM");
  launch(context, "photometric_forward", photometric_forward_kernel, {tiles, dim3(kSsimThreads), 0}, p, derivatives,
         partial);
  launch(context, "finish_photometric", finish_photometric_kernel, {dim3(1), dim3(kSumThreads), 0}, in.settings,
         in.view.counted, partial, out.terms);
  launch(context, "photometric_backward", photometric_backward_kernel, {dim3(tiles.x, tiles.y), dim3(kSsimThreads), 0},
         p, derivatives, out.gradients.color, out.residual);
}

void geometry_losses(DeviceArena& arena, const MapLossInputs& in, const MapLossOutputs& out) {
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

void map_losses(DeviceArena& arena, const MapLossInputs& in, const MapLossOutputs& out) {
  photometric_losses(arena, in, out);
  if (in.settings.has_geometry_terms(!in.neighbour.empty())) geometry_losses(arena, in, out);
}

uint64_t map_loss_scratch_bytes(const LossSettings& settings, size_t pixels) {
  // Blocks of kSsimThreads and kPixelThreads leave one sum each per term; the rest of a tile at the border is small.
  uint64_t bytes = uint64_t(3 * kPhotometricSums) * (pixels / kSsimThreads + 1) * sizeof(double);
  if (settings.weight[Loss::kSsim] != 0) bytes += uint64_t(3 * kSsimGradients) * pixels * sizeof(float);
  if (settings.has_geometry_terms(true)) {
    bytes += multi_view_bytes(settings, pixels);
    bytes += uint64_t(pixels) * (sizeof(float) + 2 * sizeof(uint8_t) + sizeof(float4));
    bytes += (uint64_t(kMeasuredSums) + uint64_t(kComparedSums)) * (pixels / kPixelThreads + 1) * sizeof(double);
  }
  return bytes;
}

}  // namespace aligngs::cuda
