// --device of the commands that train, render, fuse or run networks.
#pragma once

#include <string>

#include "cli/stages/mesh_stage.h"
#include "device/cuda_device.h"
#include "nn/compute.h"
#include "train/train_run.h"

namespace CLI {
class App;
}

namespace aligngs {

/// Adds --device; `device` is auto, cpu or cuda:N and must outlive the command.
void add_device_option(CLI::App& command, std::string& device);

/// The device itself; with `say`, `auto` says why it stays on the CPU where it does. Error{kUsage} for another text,
/// Error{kResources} for a device that is not there.
cuda::DeviceChoice chosen_device(const std::string& device, bool say);

/// Factory of the engine of that device. It reports the choice and fails like chosen_device.
EngineFactory engine_of_device(const std::string& device);

/// Factory of the same device for networks; empty for the CPU. The same errors; the message if it is to `say` it.
nn::DeviceFactory networks_of_device(const std::string& device, bool say);

/// Sets make_device of the options of a network; on a device, precision "auto" is bfloat16.
template <class Options>
void put_networks_on(const std::string& device, const std::string& precision, bool say, Options& options) {
  options.make_device = networks_of_device(device, say);
  if (options.make_device && precision == "auto") options.precision = nn::Precision::kBfloat16;
}

/// Factory of the same device for fusion; empty for the CPU. The same errors, without the message.
TsdfDeviceFactory fusion_of_device(const std::string& device);

}  // namespace aligngs
