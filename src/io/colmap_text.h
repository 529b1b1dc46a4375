// COLMAP's text files. src/io internal: use io/colmap.h.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "io/colmap.h"

namespace aligngs {

std::vector<ColmapCamera> parse_colmap_cameras_text(std::string_view text, const std::filesystem::path& name);
std::vector<ColmapImage> parse_colmap_images_text(std::string_view text, const std::filesystem::path& name);
std::vector<ColmapPoint> parse_colmap_points_text(std::string_view text, const std::filesystem::path& name);

}  // namespace aligngs
