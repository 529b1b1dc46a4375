// Inputs, scratch and sums of the three passes over the pixels (map_terms.cuh).
#pragma once

#include "device/constants.h"
#include "device/device_language.h"
#include "engine/cuda/map_losses.h"
#include "engine/cuda/partial_sums.cuh"
#include "engine/cuda/training_pixels.cuh"
#include "engine/formulas/depth_terms.h"
#include "engine/formulas/label_edges.h"
#include "engine/formulas/normal_terms.h"
#include "engine/losses/terms/pearson.h"
#include "engine/losses/terms/pixel_terms.h"

namespace aligngs::cuda {

/// Known after the first pass.
struct MeasuredTerms {
  bool pearson = false;  ///< enough pixels take part
  double pearson_count = 0, mean_rendered = 0, mean_prior = 0;
  double values[PixelTerms::kCount] = {};  ///< of the pixel terms
  float steps[PixelTerms::kCount] = {};    ///< factors of their gradients; 0: none
};
/// Known after the second.
struct ComparedTerms {
  PearsonResult pearson;
  double consistency = 0, boundary = 0, crease = 0;  ///< values
  float consistency_step = 0;                        ///< factors of the gradients; 0: none
  double boundary_step = 0, crease_step = 0;
};

struct MapTermInputs {
  RenderMapSpans maps;
  TrainingMapSpans view;
  LossSettings settings;
};
/// [H W] each.
struct MapTermScratch {
  DeviceSpan<float> depth;
  DeviceSpan<uint8_t> validity, stencil;
  DeviceSpan<float4> neighbours;  ///< dL_ng/dz of the stencil's right, left, top, bottom neighbour; where stencil != 0
  DeviceSpan<MeasuredTerms> measured;  ///< [1]
  DeviceSpan<ComparedTerms> compared;  ///< [1]
};

/// Sums of one pixel term.
enum PixelTermSum { kTermPixels, kTermWeight, kTermValue, kSumsPerTerm };
enum MeasuredSum {
  kPearsonCount,
  kPearsonRendered,
  kPearsonPrior,
  kPixelSums,  ///< PixelTermSum of each pixel term
  kMeasuredSums = kPixelSums + kSumsPerTerm * PixelTerms::kCount
};
enum ComparedSum {
  kPearsonRenderedSquares,
  kPearsonPriorSquares,
  kPearsonProducts,
  kConsistencyCount,
  kConsistencyValue,
  kBoundaryCount,
  kBoundaryValue,
  kCreaseWeight,
  kCreaseValue,
  kComparedSums
};

__device__ __forceinline__ size_t pixels_of(const MapTermInputs& in) { return in.view.flags.size; }

__device__ __forceinline__ UnitNormal<float> unit_normal_at(const MapTermInputs& in, size_t pixel) {
  return unit_normal_of(vector_at(in.maps.normal, pixel, pixels_of(in)), in.maps.alpha[pixel],
                        pixel_counts(in.view, pixel));
}
__device__ __forceinline__ float depth_weight_at(const TrainingMapSpans& view, size_t pixel) {
  return view.depth_weight.empty() ? 1.0f : view.depth_weight[pixel];
}
__device__ __forceinline__ float prior_depth_at(const TrainingMapSpans& view, size_t pixel) {
  return view.prior_depth.empty() ? 0.0f : view.prior_depth[pixel];
}
/// Pixels that L_d correlates.
__device__ __forceinline__ bool in_pearson(const MapTermInputs& in, uint8_t validity, size_t pixel) {
  return validity != kDepthInvalid && (in.view.flags[pixel] & kPixelLabelEdge) == 0 &&
         prior_depth_at(in.view, pixel) > 0;
}

}  // namespace aligngs::cuda
