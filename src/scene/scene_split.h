// Training views and test views of a scene.
#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace aligngs {

/// Fills in Scene::train and test from split.json, or by the options where it names no views. Error{kBadInput} where it
/// names unknown views, or too few are left for training. Views that no list names are no longer missed.
void read_split(const std::filesystem::path& path, const SceneOptions& options, Scene& scene);

}  // namespace aligngs
