// Options of synthetic rooms, shared by `synth` and `demo`.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cli/command.h"
#include "synth/synth_scene.h"

namespace aligngs {

struct SynthCommandOptions {
  SynthOptions synth;
  std::optional<int> test_views;
  std::string size, teacher = "simulated", level = "medium", depth = "feedforward", exposure = "photo",
                    cloud = "feedforward", labels = "teacher", segments = "none";
};

void add_synth_options(CLI::App& command, const std::shared_ptr<SynthCommandOptions>& options);
/// The options with the words resolved; Error{kUsage} for a size that is not WxH.
SynthOptions synth_options(const SynthCommandOptions& options);
/// Makes the scene with a progress line.
SynthScene make_scene(const SynthOptions& options, const CommandContext& context);

}  // namespace aligngs
