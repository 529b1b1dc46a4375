// From sums per (Gaussian, tile) to gradients of the model's parameters: slots added up in their order, then the way
// back through projection and colour.
#pragma once

#include "engine/cuda/blend_backward.h"
#include "engine/cuda/model_spans.h"
#include "engine/cuda/semantic_visit.h"

namespace aligngs::cuda {

/// touched[row] = 1 where some pixel took the Gaussian, else 0 [N]; visible[0] = the number of those rows.
void mark_touched(const DeviceContext& context, const TileListSpans& lists, const BlendRecordSpans& record,
                  DeviceSpan<uint8_t> touched, DeviceSpan<uint32_t> visible);

struct ParameterGradientSpans {
  ModelSpans model;
  ViewSpans view;
  TileListSpans lists;
  BlendRecordSpans record;
  DeviceSpan<const uint8_t> touched;           ///< [N] of mark_touched
  DeviceSpan<const SplatGradient> slots;       ///< [instances]
  DeviceSpan<const CouplingMoments> coupling;  ///< [instances]; empty: none
  DeviceSpan<const uint8_t> coupling_seen;     ///< [instances] SemanticVisitOutputs::seen
  float coupling_scale = 0;                    ///< factor on the coupling moments
  int sh_degree = 0;
  float opacity_factor = 1;  ///< of the step's OpacityDropout
};

/// Sums over touched rows of |dL/dmean|^2, pixels^-2.
enum GradientSquare : int { kPhotometricSquares, kCouplingSquares, kGradientSquares };

struct ParameterGradientOutputs {
  /// positions, log_scales, rotations, opacity_logits of every row (zero where not touched); sh of touched rows only,
  /// whole rows. The shape terms are not in them.
  ModelSpans gradients;
  DeviceSpan<DensitySums> density;  ///< [N], touched rows only; empty: not wanted
  DeviceSpan<double> squares;       ///< [GradientSquare] of the colour losses, of the coupling before its factor
  DeviceSpan<double> scratch;       ///< [square_scratch(N)]
  /// [1] lowered to bad_gradient_key of the first row and class beyond kGradientLimit; to be set to kNoBadGradient.
  DeviceSpan<unsigned long long> bad;
};
size_t square_scratch(size_t gaussians);

/// Parameter classes in the order in which they are named when a gradient is not usable.
enum class GradientClass { kPositions, kLogScales, kRotations, kOpacityLogits, kSh, kSemantics };
inline constexpr unsigned long long kNoBadGradient = ~0ull;
ALIGNGS_HD inline unsigned long long bad_gradient_key(size_t row, GradientClass c) {
  return static_cast<unsigned long long>(row) * 8 + static_cast<unsigned long long>(c);
}

void parameter_gradients(const DeviceContext& context, const ParameterGradientSpans& in,
                         const ParameterGradientOutputs& out);

}  // namespace aligngs::cuda
