// When a file changed.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

/// Changes whenever the file is replaced: time of writing and size; "" when it cannot be read.
std::string file_version(const std::filesystem::path& path);

}  // namespace aligngs
