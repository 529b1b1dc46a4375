// TSDF fusion on a CUDA device.
#pragma once

#include <cstdint>
#include <memory>

#include "mesh/tsdf_device.h"

namespace aligngs {

/// budget_bytes == 0: nine tenths of what is free on the device now. Error{kResources} when the device is not there.
std::unique_ptr<TsdfDevice> make_cuda_tsdf_device(int device, uint64_t budget_bytes = 0);

}  // namespace aligngs
