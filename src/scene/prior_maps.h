// The prior maps of a view as files: which file, what shape, what values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/npy.h"
#include "scene/scene.h"

namespace aligngs {

struct MapShape {
  int channels = 1;
  int height = 0, width = 0;
};

/// .npy, .npz of one array, or .pt / .pth (torch archive), told by the extension.
FloatArray read_map(const std::filesystem::path& path);
ArrayHeader read_map_header(const std::filesystem::path& path);

/// [h, w]; leading and trailing dimensions of 1 are accepted. Error{kBadInput} otherwise.
MapShape depth_map_shape(const std::vector<int64_t>& shape, const std::filesystem::path& path);
/// [C, h, w], or [1, C, h, w]. A C that is not `classes` is an error that names both numbers.
MapShape semantic_map_shape(const std::vector<int64_t>& shape, int classes, const std::filesystem::path& path);
/// Whether the aspect of the map is the image's within one pixel of the map.
bool has_same_aspect(const MapShape& shape, int image_width, int image_height);
/// Error{kBadInput} where it is not.
void require_same_aspect(const MapShape& shape, int image_width, int image_height, const std::filesystem::path& path,
                         const char* field);

/// Both checks of each map for the view, from the header alone (the array itself is not read).
void check_depth_header(const View& view);
void check_semantic_header(const View& view, const LabelSet& labels);

/// "[150, 240, 320]".
std::string describe_shape(const std::vector<int64_t>& shape);

}  // namespace aligngs
