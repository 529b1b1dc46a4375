#include <charconv>
#include <sstream>

#include "core/error.h"
#include "device/cuda_device.h"

namespace aligngs::cuda {

namespace {

bool runs_kernels(const CudaDevice& d) { return d.major >= kLeastCapability && d.has_code; }

std::string why_not(const CudaDevice& d) {
  const std::string has = d.name + " has compute capability " + std::to_string(d.major) + "." + std::to_string(d.minor);
  if (d.major < kLeastCapability) return has + ", and " + std::to_string(kLeastCapability) + ".0 is needed";
  return has + ", which this program was not built for (" + cuda_build() + ")";
}

/// The one with most memory among those that run the kernels, or nullptr.
const CudaDevice* roomiest(const CudaDevices& devices) {
  const CudaDevice* best = nullptr;
  for (const CudaDevice& d : devices.devices) {
    if (runs_kernels(d) && (best == nullptr || d.memory_bytes > best->memory_bytes)) best = &d;
  }
  return best;
}

DeviceChoice choose_automatically(const CudaDevices& devices, bool takes_a_device) {
  if (devices.devices.empty()) return {false, 0, "running on the CPU: " + devices.reason};
  const CudaDevice* device = roomiest(devices);
  if (device == nullptr) return {false, 0, "running on the CPU: " + why_not(devices.devices.front())};
  if (takes_a_device) return {true, device->index, {}};
  return {false, 0,
          "running on the CPU: the CUDA engine has not been run on a device yet; to try it: --device cuda:" +
              std::to_string(device->index)};
}

}  // namespace

bool architectures_run(const std::string& architectures, int major, int minor) {
  std::istringstream list(architectures);
  for (std::string entry; std::getline(list, entry, ';');) {
    int number = 0;
    const char* end = entry.data() + entry.size();
    const auto [last, status] = std::from_chars(entry.data(), end, number);
    if (status != std::errc()) continue;
    // "", "-real", "-virtual"; "a" is for that device alone
    const std::string kind(last, static_cast<size_t>(end - last));
    const int its_major = number / 10, its_minor = number % 10;
    const bool exact = major == its_major && minor == its_minor;
    const bool machine_code = kind != "-virtual" && major == its_major && minor >= its_minor;
    const bool ptx = kind != "-real" && (major > its_major || (major == its_major && minor >= its_minor));
    if (kind.empty() || kind[0] == '-' ? machine_code || ptx : exact) return true;
  }
  return false;
}

DeviceChoice choose_device(const std::string& request, const CudaDevices& devices, bool auto_takes_a_device) {
  if (request == "cpu") return {};
  if (request == "auto") return choose_automatically(devices, auto_takes_a_device);
  int index = 0;
  const std::string prefix = "cuda:";
  bool valid = request == "cuda";
  if (request.rfind(prefix, 0) == 0) {
    const char *first = request.data() + prefix.size(), *last = request.data() + request.size();
    const auto [end, status] = std::from_chars(first, last, index);
    valid = status == std::errc() && end == last && first != last && index >= 0;
  }
  if (!valid) throw_usage("--device must be auto, cpu or cuda:N, not \"" + request + "\"", "for example --device cpu");
  std::string reason = devices.devices.empty()
                           ? devices.reason
                           : "there are " + std::to_string(devices.devices.size()) + " CUDA devices, counted from 0";
  for (const CudaDevice& d : devices.devices) {
    if (d.index != index) continue;
    if (runs_kernels(d)) return {true, index, {}};
    reason = why_not(d);
  }
  throw Error({ErrorKind::kResources,
               "CUDA device " + std::to_string(index) + " is not available: " + reason,
               {},
               "--device " + request,
               "use --device cpu or --device auto"});
}

}  // namespace aligngs::cuda
