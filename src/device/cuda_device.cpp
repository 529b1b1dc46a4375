#include "device/cuda_device.h"

#include "core/error.h"
#include "device/device_calls.h"

namespace aligngs::cuda {

// Asks for properties alone: to ask for free memory would start every device, which takes some hundred MB of each.
CudaDevices list_cuda_devices() {
  CudaDevices found;
  const int count = calls::device_count(found.reason);
  for (int i = 0; i < count; ++i) {
    try {
      const calls::DeviceFacts facts = calls::facts_of(i);
      found.devices.push_back(
          {i, facts.name, facts.major, facts.minor, facts.memory_bytes, calls::has_code_for(facts.major, facts.minor)});
    } catch (const Error& error) {
      found.reason = error.details().message;
    }
  }
  if (!found.devices.empty()) found.reason.clear();
  return found;
}

}  // namespace aligngs::cuda
