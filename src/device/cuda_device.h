// Lists the CUDA devices, and chooses the device of a run. Exists in builds without CUDA as well, which have none.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aligngs::cuda {

struct CudaDevice {
  int index = 0;  ///< N of cuda:N
  std::string name;
  int major = 0, minor = 0;   ///< compute capability
  uint64_t memory_bytes = 0;  ///< that it has; what is free of it is seen when a context is made
  bool has_code = true;       ///< this build has kernels for it
};

struct CudaDevices {
  std::vector<CudaDevice> devices;
  std::string reason;  ///< why there are none; empty when there are some
};

/// Never throws: a missing driver is a reason like any other.
CudaDevices list_cuda_devices();
/// The devices that this build supports: "built without CUDA", or the toolkit and the architectures.
std::string cuda_build();

/// In builds without CUDA: Error{kResources} with this reason and the remedy.
[[noreturn]] void throw_without_cuda(int device);

/// Whether code compiled for `architectures`, as CMake lists them ("80-real;90;100-virtual"), runs on a device of that
/// compute capability. Machine code runs within its major version, PTX on everything later.
bool architectures_run(const std::string& architectures, int major, int minor);

struct DeviceChoice {
  bool cuda = false;
  int index = 0;        ///< of the CUDA device
  std::string message;  ///< why `auto` takes the CPU; empty otherwise
};

/// Whether `auto` takes a device: `ctest -L gpu` passes on one (docs/cuda.md).
inline constexpr bool kAutoTakesADevice = true;

/// Compute capability that the kernels need: bfloat16 on tensor cores came with 8.0.
inline constexpr int kLeastCapability = 8;

/// `request` is auto, cpu, cuda (the first one) or cuda:N. auto takes, if it `auto_takes_a_device`, the one with most
/// memory among those that run the kernels, else the CPU, with a message that says why. Throws Error{kUsage} for any
/// other text and Error{kResources} when cuda:N is not there, too old, or one that this build has no kernels for.
DeviceChoice choose_device(const std::string& request, const CudaDevices& devices,
                           bool auto_takes_a_device = kAutoTakesADevice);

}  // namespace aligngs::cuda
