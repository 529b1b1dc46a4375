// Seconds of the steady clock, for durations.
#pragma once

#include <chrono>

namespace aligngs {

/// Seconds since some moment of this machine that stays the same. No change of the time of day moves it.
inline double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace aligngs
