#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "device/cuda_device.h"

namespace aligngs::cuda {
namespace {

const CudaDevices kNone{{}, "built without CUDA"};
const CudaDevices kTwo{{{0, "small", 8, 6, 8}, {1, "large", 9, 0, 80}}, {}};

const CudaDevices kOldAndNew{{{0, "old", 7, 5, 99}, {1, "new", 8, 0, 8}}, {}};
const CudaDevices kOld{{{0, "old", 7, 5, 99}}, {}};

ErrorKind kind_of(const std::string& request, const CudaDevices& devices) {
  try {
    choose_device(request, devices);
  } catch (const Error& e) {
    return e.kind();
  }
  return ErrorKind::kFailed;
}

TEST(DeviceChoice, WhereAutoTakesNoDeviceItNamesTheOneWithMostMemory) {
  const DeviceChoice choice = choose_device("auto", kTwo, false);
  EXPECT_FALSE(choice.cuda);
  EXPECT_THAT(choice.message, testing::HasSubstr("--device cuda:1"));
  EXPECT_THAT(choose_device("auto", kOldAndNew, false).message, testing::HasSubstr("--device cuda:1"));
}

TEST(DeviceChoice, WhereAutoTakesADeviceItIsTheOneWithMostMemoryInSilence) {
  const DeviceChoice choice = choose_device("auto", kTwo, true);
  EXPECT_TRUE(choice.cuda);
  EXPECT_EQ(choice.index, 1);
  EXPECT_EQ(choice.message, "");
  EXPECT_EQ(choose_device("auto", kOldAndNew, true).index, 1);
}

TEST(DeviceChoice, AutoFallsBackToTheCpuAndSaysWhy) {
  for (const bool takes_a_device : {false, true}) {
    const DeviceChoice absent = choose_device("auto", kNone, takes_a_device);
    EXPECT_FALSE(absent.cuda);
    EXPECT_THAT(absent.message, testing::HasSubstr("built without CUDA"));
    const DeviceChoice old = choose_device("auto", kOld, takes_a_device);
    EXPECT_FALSE(old.cuda);
    EXPECT_THAT(old.message, testing::HasSubstr("compute capability 7.5"));
  }
}

TEST(DeviceChoice, OneConstantDecidesForAuto) { EXPECT_EQ(choose_device("auto", kTwo).cuda, kAutoTakesADevice); }

TEST(DeviceChoice, ADeviceThatIsTooOldIsAResourceError) {
  EXPECT_EQ(kind_of("cuda:0", kOldAndNew), ErrorKind::kResources);
  EXPECT_EQ(choose_device("cuda:1", kOldAndNew).index, 1);
}

TEST(DeviceChoice, ADeviceThatTheBuildHasNoKernelsForIsAResourceError) {
  const CudaDevices other{{{0, "other", 8, 9, 24, false}}, {}};
  EXPECT_EQ(kind_of("cuda:0", other), ErrorKind::kResources);
  EXPECT_THAT(choose_device("auto", other, true).message,
              testing::HasSubstr("8.9, which this program was not built for"));
}

TEST(DeviceChoice, MachineCodeRunsWithinItsMajorVersionAndPtxOnEverythingLater) {
  EXPECT_TRUE(architectures_run("80-real", 8, 0));
  EXPECT_TRUE(architectures_run("80-real", 8, 9));
  EXPECT_FALSE(architectures_run("86-real", 8, 0));
  EXPECT_FALSE(architectures_run("80-real;86-real", 9, 0));
  EXPECT_TRUE(architectures_run("90", 9, 0));
  EXPECT_TRUE(architectures_run("90", 12, 0));
  EXPECT_FALSE(architectures_run("90", 8, 9));
  EXPECT_TRUE(architectures_run("80-real;120-virtual", 12, 1));
  EXPECT_FALSE(architectures_run("90a", 10, 0));
  EXPECT_TRUE(architectures_run("90a", 9, 0));
  EXPECT_FALSE(architectures_run("", 9, 0));
  EXPECT_FALSE(architectures_run("native", 9, 0));
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
