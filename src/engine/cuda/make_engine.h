// The engine of a device that was chosen. Exists in builds without CUDA as well.
#pragma once

#include <cstdint>
#include <memory>

#include "device/cuda_device.h"
#include "engine/cuda/engine_options.h"
#include "engine/engine.h"

namespace aligngs {

/// Trains and renders on CUDA device `index` within `budget_bytes` of its memory; 0: nine tenths of what is free now.
/// `threads` are for what the host prepares once per view; 0: all. `options` change its speed, not its results. Throws
/// Error{kResources} in builds without CUDA and when the device does not answer.
std::unique_ptr<Engine> make_cuda_engine(int index, uint64_t budget_bytes = 0, int threads = 0,
                                         const cuda::CudaEngineOptions& options = {});

inline std::unique_ptr<Engine> make_engine(const cuda::DeviceChoice& choice, int threads = 0) {
  return choice.cuda ? make_cuda_engine(choice.index, 0, threads) : make_cpu_engine(threads);
}

}  // namespace aligngs
