// Stands in for TSDF fusion on a device in builds without CUDA.
#include "core/error.h"
#include "mesh/cuda/tsdf_fusion.h"

namespace aligngs {

std::unique_ptr<TsdfDevice> make_cuda_tsdf_device(int device, uint64_t) {
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(device) + " is not available: built without CUDA",
               {},
               {},
               "use --device cpu"});
}

}  // namespace aligngs
