// Products that a run has so far, as the page tells of them.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace aligngs {

/// Whether a file or a folder lies below `root`, links followed.
bool has_file(const std::filesystem::path& root, const std::string& name);
bool has_folder(const std::filesystem::path& root, const std::filesystem::path& name);

/// Names of views -> {"split": ..., "kinds": [...]} from the folders of renders/.
nlohmann::json rendered_views(const std::filesystem::path& root);

/// The classes of a run that has not written its classes.json yet: those of its scene.
nlohmann::json scene_classes(const std::filesystem::path& scene);

/// Stages of `aligngs run`, in order, and the progress of this run, whose record is `run`.
nlohmann::json run_stages(const std::filesystem::path& root, const nlohmann::json& run, bool active);

}  // namespace aligngs
