// Folders that people give in the place of a scene.
#pragma once

#include <filesystem>

namespace aligngs {

/// Error{kBadInput} for the folder of a run, whose message names the run's scene; nothing for others. `given` is the
/// folder as it was typed.
void refuse_run_folder(const std::filesystem::path& folder, const std::filesystem::path& given);

/// refuse_run_folder(). Error{kBadInput}, too, for a nerfstudio data set without a COLMAP model.
void refuse_what_is_no_scene(const std::filesystem::path& folder, const std::filesystem::path& given);

}  // namespace aligngs
