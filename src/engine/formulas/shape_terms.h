// Terms and limits of the Gaussians themselves, without rendering: flattening, opacity and scale regularisers
// (values and gradients per row) and the hard limits on shape.
#pragma once

#include <cmath>

#include "core/vec.h"
#include "engine/settings.h"

namespace aligngs {

/// Index of the smallest scale, lowest index on ties: the plane normal's axis.
template <class T>
ALIGNGS_HD inline int smallest_axis(const Vec3<T>& log_scale) {
  const int axis = log_scale.y < log_scale.x ? 1 : 0;
  return log_scale.z < log_scale[axis] ? 2 : axis;
}

/// Flattening (AlignGS, Gao et al. 2025, made scale-free): the term is the mean over the visible Gaussians of
/// min_k s_k / extent. "Visible" = blended in at least one pixel of this view. Returns this row's value before the
/// mean; its gradient with respect to log_scale[smallest_axis] is the same number.
template <class T>
ALIGNGS_HD inline T flatten_value(const Vec3<T>& log_scale, T extent) {
  using std::exp;
  return exp(log_scale[smallest_axis(log_scale)]) / extent;
}

/// Opacity regulariser (3DGS-MCMC, Kheradmand et al. 2024): the term is the mean opacity over ALL Gaussians.
/// Returns d opacity / d logit.
template <class T>
ALIGNGS_HD inline T opacity_of_logit(T logit, T& derivative) {
  using std::exp;
  const T o = T(1) / (T(1) + exp(-logit));
  derivative = o * (T(1) - o);
  return o;
}

/// Scale regulariser (3DGS-MCMC): the term is the mean over ALL Gaussians and the three axes of s / extent. Returns the
/// value of one axis before the mean; its gradient with respect to that log-scale is the same number.
template <class T>
ALIGNGS_HD inline T scale_value(T log_scale, T extent) {
  using std::exp;
  return exp(log_scale) / extent;
}

/// ShapeLimits after the optimiser step. Order: cap the largest scale, then pull the largest towards
/// the middle one, then press the smallest below its share of the middle one. A NaN stays a NaN.
template <class T>
ALIGNGS_HD inline void apply_shape_limits(const ShapeLimits& limits, Vec3<T>& log_scale) {
  using std::log;
  if (limits.scale_max > 0) {
    const T top = log(T(limits.scale_max));
    for (int k = 0; k < 3; ++k) {
      if (log_scale[k] > top) log_scale[k] = top;
    }
  }
  const int low = smallest_axis(log_scale);
  int high = low == 2 ? 1 : 2;  // of the other two axes, the larger; the higher index on ties
  const int other = 3 - low - high;
  if (log_scale[other] > log_scale[high]) high = other;
  const int middle = 3 - low - high;
  if (limits.aspect_max > 0) {
    const T top = log_scale[middle] + log(T(limits.aspect_max));
    if (log_scale[high] > top) log_scale[high] = top;
  }
  if (limits.flat_ratio_max > 0) {
    const T top = log_scale[middle] + log(T(limits.flat_ratio_max));
    if (log_scale[low] > top) log_scale[low] = top;
  }
}

/// The two larger scales are at least exp(log_floor); the smallest, the thickness of a surface, is free. A NaN stays a
/// NaN.
template <class T>
ALIGNGS_HD inline void raise_larger_scales(T log_floor, Vec3<T>& log_scale) {
  const int low = smallest_axis(log_scale);
  for (int k = 0; k < 3; ++k) {
    if (k != low && log_scale[k] < log_floor) log_scale[k] = log_floor;
  }
}

}  // namespace aligngs
