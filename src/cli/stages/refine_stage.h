// Cameras and prior depth refined before a run, into the run's own scene folder.
#pragma once

#include <filesystem>

#include "cli/command.h"

namespace aligngs {

/// Refines `scene` (which may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all. Says how far the
/// photos agreed before and after. Error{kBadInput} for a scene without prior depth.
std::filesystem::path refine_into_run(const std::filesystem::path& scene, const std::filesystem::path& run,
                                      const CommandContext& context);

/// scene.json says that its cameras were refined: nothing is left to do when a run is resumed.
bool is_refined(const std::filesystem::path& scene);

}  // namespace aligngs
