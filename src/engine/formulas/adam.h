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

/// m and v are the running moments of this number.
template <class T>
ALIGNGS_HD inline void adam_update(const AdamStep<T>& a, T gradient, T& parameter, T& m, T& v) {
  using std::sqrt;
  m = a.beta1 * m + (T(1) - a.beta1) * gradient;
  v = a.beta2 * v + (T(1) - a.beta2) * gradient * gradient;
  parameter -= a.step_size * m / (sqrt(v) * a.second_correction + a.epsilon);
}

}  // namespace aligngs
