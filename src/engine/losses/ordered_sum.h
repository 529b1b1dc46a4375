// Sums in double whose order, and so whose last bit, is fixed.
#pragma once

namespace aligngs {

/// Sum of `count` values in eight interleaved lanes: no addition waits for the one before it.
template <class T>
double ordered_sum(const T* values, int count) {
  double lane[8] = {};
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    for (int k = 0; k < 8; ++k) lane[k] += static_cast<double>(values[i + k]);
  }
  for (; i < count; ++i) lane[0] += static_cast<double>(values[i]);
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

}  // namespace aligngs
