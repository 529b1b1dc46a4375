// Forecast of a run's device memory, before it starts.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aligngs::cuda {

struct MemoryForecastInputs {
  size_t gaussians = 0;
  int channels = 0;  ///< C
  size_t pixels_per_view = 0;
  bool checkpoints = false;  ///< BlendBackwardMethod::kPerSplat
};

/// Bytes at the peak of a step with every loss on and kPairsPerGaussian (Gaussian, tile) pairs per row, without the
/// training views. A restructuring needs less: it copies one array at a time while nothing of a step is held.
uint64_t forecast_bytes(const MemoryForecastInputs& in);

}  // namespace aligngs::cuda
