// From gradients of the maps to sums per (Gaussian, tile).
#pragma once

#include <cstddef>

#include "device/device_memory.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"

namespace aligngs::cuda {

/// Sums over the pixels of one tile that one Gaussian receives; the fields of the same name in
/// engine/cpu/blend_backward.h. The coupling has its own slots (CouplingMoments, semantic_visit.h).
struct alignas(16) SplatGradient {
  float color[3];
  float weight;  ///< sum of w
  float normal[3];
  float distance;
  float p, r, one, pp;  ///< moments of g = dL/dpower in whitened coordinates (formulas/whitened.h)
  float pr, rr;
  float residual;                              ///< sum of w * colour residual
  float unsupported;                           ///< sum of w where the prior depth does not support this Gaussian
  float photometric_p, photometric_r;          ///< moments of the colour losses alone
  float photometric_abs_p, photometric_abs_y;  ///< sums of |g p| and |g (fxy p + fyy r)|
};
inline constexpr int kSplatGradientFloats = sizeof(SplatGradient) / sizeof(float);
static_assert(kSplatGradientFloats == 20, "five vectors of four");

/// Places in SplatGradient, as numbers.
enum SplatSum : int {
  kSumColor = 0,
  kSumWeight = 3,
  kSumNormal = 4,
  kSumDistance = 7,
  kSumP = 8,
  kSumR,
  kSumOne,
  kSumPp,
  kSumPr,
  kSumRr,
  kSumResidual,
  kSumUnsupported,
  kSumPhotometricP,
  kSumPhotometricR,
  kSumPhotometricAbsP,
  kSumPhotometricAbsY
};
static_assert(kSumPhotometricAbsY + 1 == kSplatGradientFloats);
static_assert(offsetof(SplatGradient, p) == kSumP * sizeof(float) &&
              offsetof(SplatGradient, rr) == kSumRr * sizeof(float));
static_assert(offsetof(SplatGradient, photometric_p) == kSumPhotometricP * sizeof(float));

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

/// Writes the sums of every seen instance (BlendRecordSpans::seen) to slots[slot]; the others stay as they are.
/// Without float atomics: the same input gives the same bits. The two methods add the same terms in other orders.
void blend_backward(const DeviceContext& context, const BlendBackwardInputs& in, DeviceSpan<SplatGradient> slots);

}  // namespace aligngs::cuda
