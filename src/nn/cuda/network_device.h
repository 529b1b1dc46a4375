// The networks on a CUDA device.
#pragma once

#include <cstdint>
#include <memory>

#include "nn/network_device.h"

namespace aligngs {

/// Weights and activations stay on the device. budget_bytes == 0: nine tenths of what is free on the device now.
/// Error{kResources} when the device is not there.
std::shared_ptr<nn::NetworkDevice> make_cuda_network_device(int device, uint64_t budget_bytes = 0);

}  // namespace aligngs
