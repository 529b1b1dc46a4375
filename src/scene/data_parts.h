// Folders of a data set that hold its photos, cameras and depth: no output goes there.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

/// Whether layouts of captures keep their data in a folder of this name (images, sparse, depth, ...).
bool is_data_part(const std::string& name);

/// The data set that `import` knows around `place`, where the folder `place` is such a part of it or lies in one; else
/// empty.
std::filesystem::path data_set_with_part(const std::filesystem::path& place);

/// Error{kUsage} where data_set_with_part() finds one.
void require_outside_of_data(const std::filesystem::path& folder);

}  // namespace aligngs
