#include "cli/device_option.h"

#include <CLI/App.hpp>

#include "core/log.h"
#include "engine/cuda/make_engine.h"
#include "mesh/cuda/tsdf_fusion.h"
#include "nn/cuda/network_device.h"

namespace aligngs {

void add_device_option(CLI::App& command, std::string& device) {
  command.add_option("--device", device, "device: auto, cpu or cuda:N")->capture_default_str()->group("Machine");
}

cuda::DeviceChoice chosen_device(const std::string& device, bool say) {
  if (device == "cpu") return {};  // without asking for devices, which takes a moment
  const cuda::DeviceChoice choice = cuda::choose_device(device, cuda::list_cuda_devices());
  if (say && !choice.message.empty()) log_info("{}", choice.message);
  return choice;
}

EngineFactory engine_of_device(const std::string& device) {
  const cuda::DeviceChoice choice = chosen_device(device, true);
  if (!choice.cuda) return make_cpu_engine;
  return [choice](int threads) { return make_engine(choice, threads); };
}

nn::DeviceFactory networks_of_device(const std::string& device, bool say) {
  const cuda::DeviceChoice choice = chosen_device(device, say);
  if (!choice.cuda) return {};
  return [choice] { return make_cuda_network_device(choice.index); };
}

TsdfDeviceFactory fusion_of_device(const std::string& device) {
  const cuda::DeviceChoice choice = chosen_device(device, false);
  if (!choice.cuda) return {};
  return [choice] { return std::shared_ptr<TsdfDevice>(make_cuda_tsdf_device(choice.index)); };
}

}  // namespace aligngs
