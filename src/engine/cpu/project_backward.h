// From the sums of blending to gradients of the rows' parameters.
#pragma once

#include <cstdint>

#include "engine/cpu/blend_backward.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cpu {

/// Gradients of one row.
struct RowGradient {
  float position[3], log_scale[3], rotation[4], opacity_logit;
};

struct ProjectBackwardInputs {
  const GaussianModel& model;
  const ProjectedView& view;
  int sh_degree = 0;
  float coupling_scale = 0;  ///< factor on the coupling moments; 0: they are not read
  float opacity_factor = 1;  ///< of the step's OpacityDropout
};

/// Largest `count` of one call: a vector of AVX-512.
inline constexpr size_t kMaxBackwardRows = 16;

/// For rows[0..count), all touched, with their sums over the view: gradients[k], and sh_gradients[rows[k]][48], whose
/// unused coefficients are set to zero.
void project_backward_rows(const ProjectBackwardInputs& in, const uint32_t* rows, const CoupledSplatGradient* sums,
                           size_t count, RowGradient* gradients, float* sh_gradients);

}  // namespace aligngs::cpu
