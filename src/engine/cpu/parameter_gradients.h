// From sums per (Gaussian, tile) to gradients of the model's parameters.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/tile_passes.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"
#include "gaussians/density_control.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cpu {

/// Gradients of all parameters but the semantic rows.
struct ParameterGradients {
  AlignedArray<float> positions, log_scales, rotations, opacity_logits;  ///< as in the model, every row
  AlignedArray<float> sh;                                                ///< [N][48], rows with touched only
  AlignedArray<DensitySums> density;                                     ///< [N], rows with touched only
  std::vector<uint8_t> touched;                                          ///< [N] 1: blended in at least one pixel
};

/// Fills touched [N], as in ParameterGradients, from what the forward pass saw; returns the number of touched rows.
size_t mark_touched(const TileLists& lists, const BlendRecord& record, ThreadPool& pool, std::vector<uint8_t>& touched);

struct ParameterGradientInputs {
  const GaussianModel& model;
  const ProjectedView& view;
  const TileLists& lists;
  const BlendRecord& record;
  const SlotGradients& slots;
  const StepRequest& request;
  size_t visible = 0;        ///< touched rows
  float coupling_scale = 0;  ///< factor on the coupling moments; 0: they are not read
};

/// Root mean squares over touched rows.
struct ParameterGradientTotals {
  double photometric_rms = 0;  ///< of d colour losses / d mean2D, pixels^-1
  double coupling_rms = 0;     ///< the same of the semantic coupling before its factor
};

/// Place of an unusable gradient: the first row, and the parameter in `term`.
struct BadGradient {
  int64_t row = -1;
  const char* term = nullptr;
};

/// Adds up the slots of each touched row and writes the parameters' gradients, the shape terms included
/// (formulas/shape_terms.h). Adds the values of these terms to `terms` and returns the first row with a gradient beyond
/// kGradientLimit.
BadGradient parameter_gradients(const ParameterGradientInputs& in, ThreadPool& pool, LossTerms& terms,
                                ParameterGradientTotals& totals, ParameterGradients& gradients);

/// Adds this view's share to the statistics of density control.
void add_density_statistics(const ParameterGradientInputs& in, const ParameterGradients& gradients, ThreadPool& pool,
                            DensityStatistics& statistics);

}  // namespace aligngs::cpu
