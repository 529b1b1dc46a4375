// For tests that run on a device or on its emulation.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "engine/cuda/runtime/cuda_device.h"
#include "engine/cuda/runtime/device_memory.h"

namespace aligngs::cuda {

#ifdef ALIGNGS_CUDA_EMULATED
constexpr bool kEmulated = true;
#else
constexpr bool kEmulated = false;
#endif

/// Skips its tests, with the reason, where there is no device.
class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    const CudaDevices found = list_cuda_devices();
    if (found.devices.empty()) GTEST_SKIP() << found.reason;
    context_ = std::make_unique<DeviceContext>(found.devices.front().index);
  }
  DeviceContext& context() { return *context_; }

 private:
  std::unique_ptr<DeviceContext> context_;
};

}  // namespace aligngs::cuda
