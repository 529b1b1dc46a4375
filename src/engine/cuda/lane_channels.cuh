// How the channels of a semantic row are spread over a warp: lane l holds channels l, l + 32, ...
#pragma once

#include "engine/cuda/semantic_rows.h"
#include "engine/cuda/warp_sums.cuh"

namespace aligngs::cuda {

inline constexpr int kLaneChannels = kMaxSemanticChannels / kWarp;

/// Channel k of this lane.
__device__ __forceinline__ int lane_channel(int k) { return static_cast<int>(lane_index()) + k * kWarp; }

}  // namespace aligngs::cuda
