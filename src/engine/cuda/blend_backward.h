// From gradients of the maps to sums per (Gaussian, tile).
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"
#include "engine/shared/splat_gradient.h"

namespace aligngs::cuda {

/// Two kernels for the same sums. The faster one depends on the device and on the number of Gaussians per tile.
enum class BlendBackwardMethod {
  kPerPixel,  ///< a thread per pixel sweeps through the list, then warps add up over the pixels
  kPerSplat   ///< a lane per Gaussian adds up while pixels pass by; needs checkpoints of the forward pass
};

struct BlendBackwardInputs {
  ViewSpans view;
  TileListSpans lists;
  BlendRecordSpans record;           ///< of the forward pass
  MapGradientSpans gradients;        ///< normal, distance and alpha are read with geometry only
  DeviceSpan<const float> residual;  ///< [H W] mean absolute colour difference, with density
  DeviceSpan<const float> prior;     ///< [H W] prior depth, 0 or not finite = none, with density; empty: none
  float prior_scale = 1;             ///< LossSettings::prior_depth_scale
  RasterSettings raster;
  bool geometry = false;  ///< some loss reached normal, distance or alpha
  bool density = false;   ///< collect residual, unsupported and the absolute sums, else they are 0
  BlendBackwardMethod method = BlendBackwardMethod::kPerPixel;
  RenderMapSpans maps{};  ///< of the forward pass; kPerSplat reads colour, with geometry normal and distance
};

/// Writes the sums of every seen instance (BlendRecordSpans::seen) to slots[slot]; the others stay as they are. The
/// coupling has its own slots (CouplingMoments, semantic_visit.h).
/// Without float atomics: the same input gives the same bits. The two methods add the same terms in other orders.
void blend_backward(const DeviceContext& context, const BlendBackwardInputs& in, DeviceSpan<SplatGradient> slots);

/// The same by kPerSplat, whatever `in` says.
void blend_backward_by_splat(const DeviceContext& context, const BlendBackwardInputs& in,
                             DeviceSpan<SplatGradient> slots);

}  // namespace aligngs::cuda
