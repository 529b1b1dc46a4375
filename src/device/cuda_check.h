// Errors of the CUDA runtime as errors of this project. For .cu files; nothing here is needed under emulation.
#pragma once

#ifndef ALIGNGS_CUDA_EMULATED

#include <cuda_runtime.h>

namespace aligngs::cuda {

/// Throws Error{kFailed} naming the operation, or Error{kResources} when the device ran out of memory or is gone.
void check_cuda(cudaError_t status, const char* operation);

}  // namespace aligngs::cuda

#endif
