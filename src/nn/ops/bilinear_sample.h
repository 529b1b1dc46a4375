// Bilinear samples of maps with their channels innermost; outside there are zeros.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.h"

namespace aligngs::nn {

struct SampledMap {
  const float* values;  ///< of the place (0, 0)
  int64_t stride;       ///< floats from place to place, row-major
  int64_t channels;     ///< to sample
  int64_t height, width;
};

/// sum[channels] += weight * map(x, y); the centre of the first place is (0, 0).
ALIGNGS_HD inline void add_bilinear_sample(const SampledMap& map, float x, float y, float weight, float* sum) {
  // Also false for NaN and for places so far away that their integer part overflows.
  if (!(x > -1 && y > -1 && x < float(map.width) && y < float(map.height))) return;
  const auto left = int64_t(std::floor(x)), top = int64_t(std::floor(y));
  const float fx = x - float(left), fy = y - float(top);
  for (int64_t corner = 0; corner < 4; ++corner) {
    const int64_t u = left + corner % 2, v = top + corner / 2;
    if (u < 0 || v < 0 || u >= map.width || v >= map.height) continue;
    const float w = weight * (corner % 2 ? fx : 1 - fx) * (corner / 2 ? fy : 1 - fy);
    const float* from = map.values + (v * map.width + u) * map.stride;
    for (int64_t c = 0; c < map.channels; ++c) sum[c] += w * from[c];
  }
}

}  // namespace aligngs::nn
