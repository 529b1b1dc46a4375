// Stands in for the CUDA sources in builds without CUDA.
#include "core/error.h"
#include "engine/cuda/make_engine.h"
#include "engine/cuda/networks/network_device.h"
#include "engine/cuda/runtime/device_ceilings.h"

namespace aligngs::cuda {

CudaDevices list_cuda_devices() { return {{}, "built without CUDA"}; }
std::string cuda_build() { return "built without CUDA"; }

CeilingEffort usual_effort() { return {}; }
DeviceCeilings measure_device_ceilings(int device, const CeilingEffort&) {
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(device) + " is not available: built without CUDA",
               {},
               {},
               "use --device cpu"});
}

}  // namespace aligngs::cuda

namespace aligngs {

std::unique_ptr<Engine> make_cuda_engine(int index, uint64_t, int, const cuda::CudaEngineOptions&) {
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(index) + " is not available: built without CUDA",
               {},
               {},
               "use --device cpu"});
}

}  // namespace aligngs

namespace aligngs {

std::shared_ptr<nn::NetworkDevice> make_cuda_network_device(int index, uint64_t) {
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(index) + " is not available: built without CUDA",
               {},
               {},
               "use --device cpu"});
}

}  // namespace aligngs
