#include "cli/device_option.h"

#include <CLI/CLI.hpp>

#include "core/log.h"
#include "engine/cuda/make_engine.h"

namespace aligngs {

void add_device_option(CLI::App& command, std::string& device) {
  command.add_option("--device", device, "auto, cpu or cuda:N")->capture_default_str();
}

EngineFactory engine_of_device(const std::string& device) {
  if (device == "cpu") return make_cpu_engine;  // without asking for devices, which takes a moment
  const cuda::DeviceChoice choice = cuda::choose_device(device, cuda::list_cuda_devices());
  if (!choice.message.empty()) log_info("{}", choice.message);
  return [choice](int threads) { return make_engine(choice, threads); };
}

}  // namespace aligngs
