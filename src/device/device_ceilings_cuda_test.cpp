// The yardstick of the stages: its kernels do what they count. Whether the rates are those of the device is for whoever
// knows the device.
#include "device/device_ceilings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "device/testing/device.h"

namespace aligngs::cuda {
namespace {

class CudaCeilings : public DeviceTest {};

TEST_F(CudaCeilings, EveryRateIsMeasured) {
  const DeviceCeilings c = measure_device_ceilings(context().device());
  for (const double rate : {c.copy_gbps, c.fma_gflops, c.mma_gflops}) {
    EXPECT_TRUE(std::isfinite(rate));
    EXPECT_GT(rate, 0);
  }
  if (kEmulated) return;
  EXPECT_GT(c.mma_gflops, c.fma_gflops) << "tensor cores are there to be faster";
}

TEST_F(CudaCeilings, MemoryThatIsNotThereIsTyped) {
  CeilingEffort effort = usual_effort();
  effort.copy_bytes = uint64_t(1) << 50;
  try {
    measure_device_ceilings(context().device(), effort);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
  }
}

}  // namespace
}  // namespace aligngs::cuda
