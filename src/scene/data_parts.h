// Folders of a data set that hold its photos, cameras and depth: no output goes there.
#pragma once

#include <filesystem>

namespace aligngs {

/// Whether layouts of captures keep their data in a folder of this name (images, images_4, sparse, depth, ...). Other
/// names that begin with "images" or "depth" count where the folder is there and pictures lie in it. A new
/// `depth_run` is free.
bool is_data_part(const std::filesystem::path& folder);

/// The data set that `import` knows around `place`, where the folder `place` is such a part of it or lies in one; else
/// empty.
std::filesystem::path data_set_with_part(const std::filesystem::path& place);

/// Error{kUsage} where data_set_with_part() finds one.
void require_outside_of_data(const std::filesystem::path& folder);

}  // namespace aligngs
