#include "engine/cuda/multi_view.h"

#include "device/launch.h"
#include "engine/cuda/multi_view.cuh"

namespace aligngs::cuda {
namespace {

DeviceSpan<float> make_grey(DeviceArena& arena, const TrainingMapSpans& view) {
  const size_t pixels = view.flags.size;
  const DeviceSpan<float> grey = arena.take<float>(pixels, "grey photo");
  launch(arena.context(), "grey", grey_kernel, one_per_item(pixels, kPixelThreads), view, grey);
  return grey;
}

}  // namespace

void keep_neighbour_depth(const DeviceContext& context, const RenderMapSpans& maps, const TrainingMapSpans& view,
                          bool paper_normals, DeviceSpan<float> depth) {
  launch(context, "keep_neighbour_depth", keep_neighbour_depth_kernel, one_per_item(depth.size, kPixelThreads), maps,
         view, paper_normals, depth);
}

MultiViewGradients multi_view_losses(DeviceArena& arena, const MultiViewInputs& in, DeviceSpan<LossTerms> terms) {
  const DeviceContext& context = arena.context();
  const size_t pixels = in.depth.size;
  const LaunchShape shape = one_per_item(pixels, kPixelThreads), one{dim3(1), dim3(kSumThreads), 0};
  const DeviceSpan<float> agreement = arena.take<float>(pixels, "agreement of two views"),
                          slope = arena.take<float>(pixels, "agreement of two views");
  const DeviceSpan<MultiViewSteps> steps = arena.take<MultiViewSteps>(1, "multi-view terms");
  const auto agreement_sums = arena.take<double>(shape.grid.x * size_t(kAgreementSums), "sums of the losses");
  launch(context, "agreement", agreement_kernel, shape, in, agreement, slope, agreement_sums);
  launch(context, "finish_agreement", finish_agreement_kernel, one, in.settings, pixels, agreement_sums, steps, terms);
  MultiViewGradients out;
  out.steps = steps;
  if (in.settings.weight[Loss::kMultiViewGeometric] != 0) out.depth = slope;
  if (in.settings.weight[Loss::kMultiViewPhotometric] == 0) return out;

  const GreyImages<float> images{make_grey(arena, in.view).data, make_grey(arena, in.neighbour.view).data};
  const DeviceSpan<float> plane = arena.take<float>(4 * pixels, "gradients of patches");
  const auto patch_sums = arena.take<double>(shape.grid.x * size_t(kPatchSums), "sums of the losses");
  launch(context, "patches", patch_kernel, shape, in, images, agreement, steps, plane, patch_sums);
  launch(context, "finish_patches", finish_patches_kernel, one, in.settings, patch_sums, steps, terms);
  out.plane = plane;
  return out;
}

uint64_t multi_view_bytes(const LossSettings& settings, size_t pixels) {
  if (!settings.has(LossStage::kTwoViews)) return 0;
  const uint64_t blocks = pixels / kPixelThreads + 1;
  uint64_t bytes = 2 * uint64_t(pixels) * sizeof(float) + blocks * kAgreementSums * sizeof(double);
  if (settings.weight[Loss::kMultiViewPhotometric] != 0) {
    bytes += 6 * uint64_t(pixels) * sizeof(float) + blocks * kPatchSums * sizeof(double);  // two photos, four gradients
  }
  return bytes;
}

}  // namespace aligngs::cuda
