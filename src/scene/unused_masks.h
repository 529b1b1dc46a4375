// Masks that hide nothing, because no photo has their name or their folder has another one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/view_data.h"

namespace aligngs {

/// A warning for each folder of masks around the photos that holds such masks. `folder`: the scene, the capture or the
/// folder of photos. Folders outside of it are not looked at, but for the one around images/. `named`: masks that a
/// file of cameras names.
std::vector<SceneProblem> unused_masks(const std::filesystem::path& folder,
                                       const std::vector<std::filesystem::path>& photos,
                                       const std::vector<std::filesystem::path>& named = {});

/// The same as a sentence with its remedy.
std::string text_of_unused_masks(const SceneProblem& problem);

}  // namespace aligngs
