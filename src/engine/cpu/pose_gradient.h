// The camera's share of a step's gradients (formulas/pose_gradient.h), summed over the rows.
#pragma once

#include "core/thread_pool.h"
#include "engine/cpu/parameter_gradients.h"
#include "engine/formulas/pose_gradient.h"

namespace aligngs::cpu {

/// From gradients of the step's losses as parameter_gradients() leaves them and the model that they were taken at. The
/// same bits for any number of threads.
PoseGradient<double> pose_gradient(const GaussianModel& model, const ParameterGradients& gradients,
                                   const Camera& camera, int sh_degree, ThreadPool& pool);

}  // namespace aligngs::cpu
