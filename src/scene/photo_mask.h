// Masks of photos: pictures in masks/, as COLMAP and nerfstudio have them. A value of 0 leaves the pixel out.
#pragma once

#include <filesystem>

#include "core/image.h"

namespace aligngs {

inline constexpr const char* kMaskFolder = "masks";

/// The mask of a photo, empty when there is none. It lies in a folder masks/ beside the photo, or beside one of the two
/// folders around it, with the same path from there. For images/left/a.jpg: masks/left/a.jpg.png (COLMAP),
/// masks/left/a.png or masks/left/a.jpg.
std::filesystem::path find_mask(const std::filesystem::path& photo);

/// The mask for pixels of the photo at width x height, 255 = use, else 0. `upright`: for the photo after EXIF
/// orientation, else for its stored pixels. A mask of the aspect of the stored pixels is turned with them; one that
/// fits the upright photo alone is used as it is. In a PNG every value but 0 counts; in a JPEG values from 128 do.
/// Error{kBadInput} when the mask has another aspect or cannot be read.
Image<uint8_t> read_mask(const std::filesystem::path& mask, const std::filesystem::path& photo, bool upright, int width,
                         int height);

}  // namespace aligngs
