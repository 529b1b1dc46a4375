// Options of synthetic rooms, shared by `synth` and `demo`.
#pragma once

#include <memory>
#include <string>

#include "cli/command.h"
#include "synth/synth_scene.h"

namespace aligngs {

struct SynthCommandOptions {
  SynthOptions synth;
  std::string size, teacher = "simulated", level = "medium", depth = "feedforward", cloud = "feedforward", labels = "teacher";
};

void add_synth_options(CLI::App& command, const std::shared_ptr<SynthCommandOptions>& options);
/// The options with the words resolved; Error{kUsage} for a size that is not WxH.
SynthOptions synth_options(const SynthCommandOptions& options);
/// Makes the scene with a progress line and writes it.
SynthScene make_and_write_scene(const SynthOptions& options, const std::filesystem::path& folder, bool overwrite,
                                const CommandContext& context);

}  // namespace aligngs
