// On a CUDA device, or on its emulation. The limits are those of the processor.
#include <cstdio>

#include "device/cuda_device.h"
#include "nn/cuda/network_device.h"
#include "parity_case.h"

namespace aligngs::parity {

const std::vector<Mode>& modes() {
  static const std::vector<Mode> list = [] {
    const cuda::DeviceChoice choice = cuda::choose_device("auto", cuda::list_cuda_devices(), true);
    if (!choice.cuda) {
      std::printf("skipped: %s\n", choice.message.c_str());
      return std::vector<Mode>();
    }
    const auto device = make_cuda_network_device(choice.index);
    return std::vector<Mode>{{"float32 CUDA", {nn::Precision::kFloat32, false, false, device}, 2e-5, 2e-5, 0},
                             {"bfloat16 CUDA", {nn::Precision::kBfloat16, false, false, device}, 6e-2, 2e-2, 0.03}};
  }();
  return list;
}

}  // namespace aligngs::parity
