#include "engine/cuda/runtime/cuda_device.h"

#include <optional>

#include "core/error.h"
#include "engine/cuda/runtime/device_calls.h"

namespace aligngs::cuda {
namespace {

/// The current device of the calling thread is what it was when this is gone.
class DeviceScope {
 public:
  DeviceScope() : device_(calls::current_device()) {}
  ~DeviceScope() {
    try {
      if (calls::current_device() != device_) calls::set_device(device_);
    } catch (const Error&) {  // a thread that never chose stands on a first device that may be taken: nothing is lost
    }
  }
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int device_;
};

/// Nothing when it is busy or exclusively taken.
std::optional<CudaDevice> ask(int index) {
  try {
    const calls::DeviceFacts facts = calls::facts_of(index);
    calls::set_device(index);
    const calls::DeviceMemory memory = calls::memory_of_current_device();
    return CudaDevice{index, facts.name, facts.major, facts.minor, memory.total_bytes, memory.free_bytes};
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

CudaDevices list_cuda_devices() {
  CudaDevices found;
  const int count = calls::device_count(found.reason);
  if (count == 0) return found;
  const DeviceScope scope;
  for (int i = 0; i < count; ++i) {
    if (const std::optional<CudaDevice> device = ask(i)) found.devices.push_back(*device);
  }
  if (found.devices.empty()) found.reason = "no CUDA device answers";
  return found;
}

}  // namespace aligngs::cuda
