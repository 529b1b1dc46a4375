// Kernels of multi_view.h. A pixel forms its own terms and gradients alone; only the normalisations are sums over all.
#include "engine/cuda/multi_view.h"

#include "device/constants.h"
#include "device/device_language.h"
#include "device/launch.h"
#include "engine/cuda/partial_sums.cuh"
#include "engine/cuda/training_pixels.cuh"
#include "engine/formulas/patch_draw.h"
#include "engine/formulas/patch_score.h"

namespace aligngs::cuda {

enum AgreementSum { kAgreementCount, kAgreementDistance, kAgreementSums };
enum PatchSum { kPatchCount, kPatchValue, kPatchSums };

__global__ void __launch_bounds__(kPixelThreads)
    keep_neighbour_depth_kernel(RenderMapSpans maps, TrainingMapSpans view, bool paper_normals,
                                DeviceSpan<float> depth) {
  const size_t i = item_index();
  if (i >= depth.size) return;
  const DepthSample<float> sample = depth_sample_at(maps, view, paper_normals, i);
  depth[i] = sample.level == float(kDepthTight) ? sample.z : 0.0f;
}

__global__ void __launch_bounds__(kPixelThreads) grey_kernel(TrainingMapSpans view, DeviceSpan<float> grey) {
  const size_t i = item_index(), pixels = grey.size;
  if (i >= pixels) return;
  grey[i] = grey_of(truth_at(view, i), truth_at(view, pixels + i), truth_at(view, 2 * pixels + i));
}

/// Per pixel w = exp(-phi), 0 where the views do not see the same point, and w dphi / dz.
__global__ void __launch_bounds__(kPixelThreads) agreement_kernel(MultiViewInputs in, DeviceSpan<float> agreement,
                                                                  DeviceSpan<float> slope, DeviceSpan<double> partial) {
  const size_t i = item_index();
  float sums[kAgreementSums] = {};
  if (i < agreement.size) {
    const size_t width = static_cast<size_t>(in.maps.width);
    Reprojection<float> r;
    if (in.validity[i] == kDepthTight) {
      r = forward_backward(in.neighbour.views, in.neighbour.depth.data, in.depth[i],
                           Vec2<float>{float(i % width) + 0.5f, float(i / width) + 0.5f});
    }
    const float w = r.valid ? std::exp(-r.distance) : 0.0f;
    agreement[i] = w;
    slope[i] = w * r.slope;
    sums[kAgreementCount] = r.valid ? 1 : 0;
    sums[kAgreementDistance] = w * r.distance;
  }
  store_partial_sums(sums, partial);
}

__global__ void __launch_bounds__(kSumThreads)
    finish_agreement_kernel(LossSettings settings, size_t pixels, DeviceSpan<const double> partial,
                            DeviceSpan<MultiViewSteps> steps, DeviceSpan<LossTerms> terms) {
  double s[kAgreementSums];
  load_partial_sums(partial, s);
  if (threadIdx.x != 0) return;
  MultiViewSteps out;
  const double count = s[kAgreementCount];
  if (enough_valid(count, static_cast<double>(pixels))) {
    out.share = patch_share(count, static_cast<double>(pixels));
    if (settings.weight[Loss::kMultiViewGeometric] != 0) {
      out.geometric = static_cast<float>(settings.weight[Loss::kMultiViewGeometric] / count);
      terms[0].add(Loss::kMultiViewGeometric, settings.weight[Loss::kMultiViewGeometric],
                   s[kAgreementDistance] / count);
    }
  }
  steps[0] = out;
}

/// The patches that are drawn: a thread each, because they are few and far apart; its 147 samples are in local memory.
__global__ void __launch_bounds__(kPixelThreads)
    patch_kernel(MultiViewInputs in, GreyImages<float> images, DeviceSpan<const float> agreement,
                 DeviceSpan<const MultiViewSteps> steps, DeviceSpan<float> plane, DeviceSpan<double> partial) {
  const size_t i = item_index(), pixels = agreement.size;
  float sums[kPatchSums] = {};
  if (i < pixels) {
    const float w = agreement[i];
    PatchScore<float> s;
    if (w > 0 && draws_patch(in.neighbour.seed, i, steps[0].share)) {
      const BlendedPlane<float> blended{{in.maps.normal[i], in.maps.normal[pixels + i], in.maps.normal[2 * pixels + i]},
                                        in.maps.distance[i],
                                        in.maps.alpha[i]};
      const size_t width = static_cast<size_t>(in.maps.width);
      s = patch_score(in.neighbour.views, images, blended, static_cast<int>(i % width), static_cast<int>(i / width));
    }
    for (int k = 0; k < 3; ++k) plane[size_t(k) * pixels + i] = s.used ? w * s.d_normal[k] : 0.0f;
    plane[3 * pixels + i] = s.used ? w * s.d_distance : 0.0f;
    sums[kPatchCount] = s.used ? 1 : 0;
    sums[kPatchValue] = s.used ? w * s.score : 0.0f;
  }
  store_partial_sums(sums, partial);
}

__global__ void __launch_bounds__(kSumThreads)
    finish_patches_kernel(LossSettings settings, DeviceSpan<const double> partial, DeviceSpan<MultiViewSteps> steps,
                          DeviceSpan<LossTerms> terms) {
  double s[kPatchSums];
  load_partial_sums(partial, s);
  if (threadIdx.x != 0 || s[kPatchCount] == 0) return;
  steps[0].photometric = static_cast<float>(settings.weight[Loss::kMultiViewPhotometric] / s[kPatchCount]);
  terms[0].add(Loss::kMultiViewPhotometric, settings.weight[Loss::kMultiViewPhotometric],
               s[kPatchValue] / s[kPatchCount]);
}
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
