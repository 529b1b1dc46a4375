// Replaces TSDF fusion on a device in builds without CUDA.
#include "device/cuda_device.h"
#include "mesh/cuda/tsdf_fusion.h"

namespace aligngs {

std::unique_ptr<TsdfDevice> make_cuda_tsdf_device(int device, uint64_t) { cuda::throw_without_cuda(device); }

}  // namespace aligngs
