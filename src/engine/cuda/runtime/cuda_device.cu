#include "engine/cuda/runtime/cuda_device.h"

#include "engine/cuda/runtime/cuda_check.h"

namespace aligngs::cuda {

#ifdef ALIGNGS_CUDA_EMULATED

CudaDevices list_cuda_devices() { return {{{0, "emulated CUDA device", 0, 0, 0, 0}}, {}}; }
std::string cuda_build() { return "emulated on the CPU"; }

#else

CudaDevices list_cuda_devices() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess || count == 0) {
    (void)cudaGetLastError();
    return {{}, status == cudaSuccess ? "no CUDA device" : std::string("no CUDA device: ") + cudaGetErrorString(status)};
  }
  CudaDevices found;
  for (int i = 0; i < count; ++i) {
    cudaDeviceProp properties{};
    size_t free_bytes = 0, total_bytes = 0;
    if (cudaGetDeviceProperties(&properties, i) != cudaSuccess || cudaSetDevice(i) != cudaSuccess ||
        cudaMemGetInfo(&free_bytes, &total_bytes) != cudaSuccess) {
      (void)cudaGetLastError();
      continue;  // busy or exclusively taken: not available
    }
    found.devices.push_back({i, properties.name, properties.major, properties.minor, total_bytes, free_bytes});
  }
  if (found.devices.empty()) found.reason = "no CUDA device answers";
  return found;
}

std::string cuda_build() {
  return "CUDA " + std::to_string(CUDART_VERSION / 1000) + "." + std::to_string(CUDART_VERSION % 1000 / 10) +
         ", architectures " ALIGNGS_CUDA_ARCHITECTURES;
}

#endif

}  // namespace aligngs::cuda
