// Replaces the CUDA sources in builds without CUDA.
#include "core/error.h"
#include "device/device_ceilings.h"
#include "engine/cuda/make_engine.h"
#include "nn/cuda/network_device.h"

namespace aligngs::cuda {

CudaDevices list_cuda_devices() { return {{}, "built without CUDA"}; }
std::string cuda_build() { return "built without CUDA"; }

void throw_without_cuda(int device) {
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(device) + " is not available: built without CUDA",
               {},
               {},
               "use --device cpu"});
}

CeilingEffort usual_effort() { return {}; }
DeviceCeilings measure_device_ceilings(int device, const CeilingEffort&) { throw_without_cuda(device); }

}  // namespace aligngs::cuda

namespace aligngs {

std::unique_ptr<Engine> make_cuda_engine(int index, uint64_t, int, const cuda::CudaEngineOptions&) {
  cuda::throw_without_cuda(index);
}

std::shared_ptr<nn::NetworkDevice> make_cuda_network_device(int index, uint64_t) { cuda::throw_without_cuda(index); }

}  // namespace aligngs
