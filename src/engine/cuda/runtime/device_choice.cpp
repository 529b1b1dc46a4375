#include <algorithm>
#include <charconv>

#include "core/error.h"
#include "engine/cuda/runtime/cuda_device.h"

namespace aligngs::cuda {

DeviceChoice choose_device(const std::string& request, const CudaDevices& devices) {
  if (request == "cpu") return {};
  if (request == "auto") {
    if (devices.devices.empty()) return {false, 0, "running on the CPU: " + devices.reason};
    const auto roomiest =
        std::max_element(devices.devices.begin(), devices.devices.end(),
                         [](const CudaDevice& a, const CudaDevice& b) { return a.free_bytes < b.free_bytes; });
    // Results are compared with the CPU's on an emulated device only; whoever asks for a real one by name knows that.
    return {false, 0, "running on the CPU: the CUDA engine has not been run on a device yet; to try it: --device cuda:" +
                          std::to_string(roomiest->index)};
  }
  int index = 0;
  const std::string prefix = "cuda:";
  bool valid = request == "cuda";
  if (request.rfind(prefix, 0) == 0) {
    const char *first = request.data() + prefix.size(), *last = request.data() + request.size();
    const auto [end, status] = std::from_chars(first, last, index);
    valid = status == std::errc() && end == last && first != last && index >= 0;
  }
  if (!valid) throw_usage("--device must be auto, cpu or cuda:N, not \"" + request + "\"", "for example --device cpu");
  for (const CudaDevice& d : devices.devices) {
    if (d.index == index) return {true, index, {}};
  }
  const std::string reason =
      devices.devices.empty()
          ? devices.reason
          : "there are " + std::to_string(devices.devices.size()) + " CUDA devices, counted from 0";
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(index) + " is not available: " + reason,
               {},
               "--device " + request,
               "use --device cpu or --device auto"});
}

}  // namespace aligngs::cuda
