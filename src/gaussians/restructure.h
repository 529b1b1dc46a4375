// Carrying out a plan of gaussians/density_control.h on arrays of one row per Gaussian.
#pragma once

#include <cstddef>
#include <vector>

#include "gaussians/density_control.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// Carries out a plan on the parameters.
void restructure_model(const RestructurePlan& plan, GaussianModel& model);

/// Carries out a plan on a per-row array of `width` values per row; new rows are zero (for moments). If the array has
/// the capacity, its memory is kept. A plan that drops and adds a few rows of many must not take hundreds of megabytes
/// of fresh pages.
void restructure_rows(const RestructurePlan& plan, size_t width, std::vector<float>& rows);

}  // namespace aligngs
