// Adam (Kingma and Ba 2015) for one number, with bias correction, in the arrangement of 3DGS (epsilon 1e-15).
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.h"
#include "engine/settings.h"

namespace aligngs {

/// Constants of one step for one parameter class.
template <class T>
struct AdamStep {
  T step_size{};          ///< rate / (1 - beta1^t)
  T second_correction{};  ///< 1 / sqrt(1 - beta2^t)
  T beta1{}, beta2{}, epsilon{};
};

/// `step` is 1-based. Computed in double: 1 - beta2^t loses everything in float at t = 1.
template <class T>
inline AdamStep<T> make_adam_step(const AdamSettings& settings, double rate, int64_t step) {
  const double t = static_cast<double>(step < 1 ? 1 : step);
  const double c1 = 1.0 - std::pow(static_cast<double>(settings.beta1), t);
  const double c2 = 1.0 - std::pow(static_cast<double>(settings.beta2), t);
  return {T(rate / c1), T(1.0 / std::sqrt(c2)), T(settings.beta1), T(settings.beta2), T(settings.epsilon)};
}

/// AdamStep of rows that are not updated at every step. The moments of a row know only its own updates, so its bias
/// correction counts those. With the number of the step instead, the first update of a row would be too large: (1 -
/// beta1) / sqrt(1 - beta2) = 3.2 times the rate.
struct AdamRowSteps {
  AdamStep<float> any;  ///< what all rows have in common
  float rate = 0, log_beta1 = 0, log_beta2 = 0;
  float last = 1;  ///< number of the step; no row has had more updates

  /// For a row's update number `count`, 1-based. 1 - beta^t by expm1 keeps its digits for small t.
  ALIGNGS_HD AdamStep<float> at(float count) const {
    const float t = count >= 1 ? (count < last ? count : last) : 1;  // also where a file holds NaN
    AdamStep<float> step = any;
    step.step_size = rate / -std::expm1(t * log_beta1);
    step.second_correction = 1 / std::sqrt(-std::expm1(t * log_beta2));
    return step;
  }
};
inline AdamRowSteps make_adam_row_steps(const AdamSettings& settings, float rate, int64_t step) {
  return {make_adam_step<float>(settings, static_cast<double>(rate), step), rate,
          static_cast<float>(std::log(static_cast<double>(settings.beta1))),
          static_cast<float>(std::log(static_cast<double>(settings.beta2))), static_cast<float>(step < 1 ? 1 : step)};
}

/// m and v are the running moments of this number.
template <class T>
ALIGNGS_HD inline void adam_update(const AdamStep<T>& a, T gradient, T& parameter, T& m, T& v) {
  using std::sqrt;
  m = a.beta1 * m + (T(1) - a.beta1) * gradient;
  v = a.beta2 * v + (T(1) - a.beta2) * gradient * gradient;
  parameter -= a.step_size * m / (sqrt(v) * a.second_correction + a.epsilon);
}

}  // namespace aligngs
