// For tests that run on a device or on its emulation.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "device/cuda_device.h"
#include "device/device_memory.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/emulation.h"
#endif

namespace aligngs::cuda {

#ifdef ALIGNGS_CUDA_EMULATED
constexpr bool kEmulated = true;

/// Runs `body` once in each order in which an emulated block may run its threads; on a device twice.
template <class Body>
void for_each_thread_order(const Body& body) {
  for (const ThreadOrder order : {ThreadOrder::kForward, ThreadOrder::kReverse, ThreadOrder::kShuffled}) {
    const ScopedThreadOrder scope(order, 7);
    body();
  }
}
#else
constexpr bool kEmulated = false;

template <class Body>
void for_each_thread_order(const Body& body) {
  for (int repeat = 0; repeat < 2; ++repeat) body();
}
#endif

/// The device that tests run on, or why there is none.
inline DeviceChoice test_device() { return choose_device("auto", list_cuda_devices(), true); }

/// Skips its tests, with the reason, where there is no device that runs the kernels.
class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    const DeviceChoice choice = test_device();
    if (!choice.cuda) GTEST_SKIP() << choice.message;
    context_ = std::make_unique<DeviceContext>(choice.index);
  }
  DeviceContext& context() { return *context_; }

 private:
  std::unique_ptr<DeviceContext> context_;
};

}  // namespace aligngs::cuda
