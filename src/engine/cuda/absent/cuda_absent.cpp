// Stands in for the CUDA sources in builds without CUDA.
#include "engine/cuda/runtime/cuda_device.h"

namespace aligngs::cuda {

CudaDevices list_cuda_devices() { return {{}, "built without CUDA"}; }
std::string cuda_build() { return "built without CUDA"; }

}  // namespace aligngs::cuda
