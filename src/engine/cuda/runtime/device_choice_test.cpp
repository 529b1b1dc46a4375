#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "engine/cuda/runtime/cuda_device.h"

namespace aligngs::cuda {
namespace {

const CudaDevices kNone{{}, "built without CUDA"};
const CudaDevices kTwo{{{0, "small", 8, 6, 8, 7}, {1, "large", 9, 0, 80, 70}}, {}};

ErrorKind kind_of(const std::string& request, const CudaDevices& devices) {
  try {
    choose_device(request, devices);
  } catch (const Error& e) {
    return e.kind();
  }
  return ErrorKind::kFailed;
}

TEST(DeviceChoice, AutoStaysOnTheCpuAndNamesTheDeviceWithMostFreeMemory) {
  const DeviceChoice choice = choose_device("auto", kTwo);
  EXPECT_FALSE(choice.cuda);
  EXPECT_THAT(choice.message, testing::HasSubstr("--device cuda:1"));
}

TEST(DeviceChoice, AutoFallsBackToTheCpuAndSaysWhy) {
  const DeviceChoice choice = choose_device("auto", kNone);
  EXPECT_FALSE(choice.cuda);
  EXPECT_THAT(choice.message, testing::HasSubstr("built without CUDA"));
}

TEST(DeviceChoice, CpuStaysOnTheCpuInSilence) {
  EXPECT_FALSE(choose_device("cpu", kTwo).cuda);
  EXPECT_EQ(choose_device("cpu", kTwo).message, "");
}

TEST(DeviceChoice, AnAbsentDeviceIsAResourceError) {
  EXPECT_EQ(kind_of("cuda:0", kNone), ErrorKind::kResources);
  EXPECT_EQ(kind_of("cuda:2", kTwo), ErrorKind::kResources);
  EXPECT_EQ(choose_device("cuda:1", kTwo).index, 1);
  EXPECT_EQ(choose_device("cuda", kTwo).index, 0);
}

TEST(DeviceChoice, AnythingElseIsAUsageError) {
  for (const char* text : {"", "gpu", "cuda:", "cuda:x", "cuda:1x", "cuda:-1", "cuda:99999999999", "cuda0", "CPU"}) {
    EXPECT_EQ(kind_of(text, kTwo), ErrorKind::kUsage) << text;
  }
}

}  // namespace
}  // namespace aligngs::cuda
