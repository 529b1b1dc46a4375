// The absolute colour difference at one pixel of one channel. Engines form it beside the rows that SSIM lays out, so
// they have loops of their own for it.
#pragma once

#include <cmath>

#include "core/always_inline.h"
#include "core/host_device.h"

namespace aligngs {

template <class T>
struct ColorDifference {
  T absolute{};  ///< |render - truth|
  T squared{};   ///< squared difference as shown, i.e. of the render clamped to [0, 1]
  T gradient{};  ///< step times the sign of render - truth
};
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE ColorDifference<T> color_difference(T render, T truth, T step) {
  using std::abs;
  const T d = render - truth;
  const T low = render < T(0) ? T(0) : render;
  const T shown = (low > T(1) ? T(1) : low) - truth;
  return {abs(d), shown * shown, d > T(0) ? step : (d < T(0) ? -step : T(0))};
}

}  // namespace aligngs
