// Key frames of a camera as a JSON file. docs/page.md describes it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/camera_path.h"

namespace aligngs {

/// {"format": "aligngs camera path", "version": 1, "keys": [{"time", "eye", "target", "fov"}, ...]} with 1 to 1000
/// keys.
/// Times are seconds that rise strictly within an hour. Places are in scene units. "fov" is in degrees, 5 to 150;
/// absent: 62.
/// Error{kBadInput} naming the field of what is wrong.
CameraPath parse_camera_path(std::string_view text, const std::filesystem::path& name_for_errors);
CameraPath read_camera_path(const std::filesystem::path& file);

/// The file's text, with a line break at its end.
std::string camera_path_json(const CameraPath& path);

}  // namespace aligngs
