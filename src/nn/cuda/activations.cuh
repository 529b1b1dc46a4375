// The activation functions of networks.
#pragma once

#include <cmath>

#include "device/device_language.h"
#include "nn/cpu/row_kernels.h"

namespace aligngs::cuda {

__device__ __forceinline__ float silu(float x) { return x / (1.0f + std::exp(-x)); }

__device__ __forceinline__ float activated(float x, nn::Activation activation) {
  constexpr float kRootHalf = 0.70710678f;
  switch (activation) {
    case nn::Activation::kRelu:
      return x > 0.0f ? x : 0.0f;
    case nn::Activation::kGelu:
      return 0.5f * x * (1.0f + std::erf(x * kRootHalf));
    case nn::Activation::kSilu:
      return silu(x);
    case nn::Activation::kNone:
      break;
  }
  return x;
}

}  // namespace aligngs::cuda
