// --device of the commands that train or render.
#pragma once

#include <string>

#include "train/train_run.h"

namespace CLI {
class App;
}

namespace aligngs {

/// Adds --device; `device` is auto, cpu or cuda:N and must outlive the command.
void add_device_option(CLI::App& command, std::string& device);

/// What makes the engine of that device. `auto` says why it runs on the CPU where it does. Error{kUsage} for another
/// text, Error{kResources} for a device that is not there.
EngineFactory engine_of_device(const std::string& device);

}  // namespace aligngs
