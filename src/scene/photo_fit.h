// Decides which pixels of a photo a given camera speaks of, and at what scale: asked by everything that pairs photos
// with cameras.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/image.h"
#include "io/image_file.h"

namespace aligngs {

/// COLMAP and nerfstudio find cameras in the pixels as stored; tools that turn photos first find them in the upright
/// ones.
struct PhotoFit {
  bool upright = false;       ///< false: pixels as stored, true: after EXIF orientation
  int width = 0, height = 0;  ///< of the photo, in that order of pixels
};

/// The stored pixels where they have the camera's size or its aspect (within a pixel of rounding), else the upright
/// ones where those do. Empty when neither does.
std::optional<PhotoFit> fit_photo(const ImageInfo& photo, int camera_width, int camera_height);

/// The same; Error{kBadInput} with both sizes when the photo does not fit.
PhotoFit require_photo_fit(const std::filesystem::path& file, const ImageInfo& photo, int camera_width,
                           int camera_height);

/// The pixels that fit_photo() chose.
Image<uint8_t> read_photo(const std::filesystem::path& file, bool upright);

/// Whether a camera of this size is for the upright pixels: the stored ones have another size.
bool is_upright_of_size(const ImageInfo& photo, int width, int height);

/// The pixels of a photo that has a camera of this very size: stored ones where they have it, else the upright ones.
Image<uint8_t> read_photo_of_size(const std::filesystem::path& file, int width, int height);

}  // namespace aligngs
