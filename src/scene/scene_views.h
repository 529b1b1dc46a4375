// Views of a scene folder: cameras of its COLMAP model, each with its photo and its maps.
#pragma once

#include <filesystem>
#include <vector>

#include "io/colmap.h"
#include "scene/scene.h"

namespace aligngs {

/// In the order of their names. Views that cannot be used are added to `left_out`. Error{kBadInput} where what is wrong
/// is no matter of single views.
std::vector<View> read_views(const ColmapModel& model, const std::filesystem::path& folder,
                             const std::filesystem::path& model_folder, std::vector<LeftOut>& left_out);

}  // namespace aligngs
