// EXIF orientation: how a camera was held, and turning the picture upright.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/image.h"

namespace aligngs {

/// 1 to 8 (EXIF 2.3, tag 0x0112); 1 (upright) when the tag is absent or nonsense. `exif` is the
/// content of a JPEG APP1 segment, "Exif\0\0" included.
int exif_orientation(std::string_view exif);

/// Sets the orientation that `bytes` hold from `begin` on (content as for exif_orientation) to 1, without moving a
/// byte.
/// false: there is no such tag.
bool set_exif_upright(std::string& bytes, size_t begin, size_t size);

/// Whether upright width and height are the stored height and width.
inline bool orientation_swaps_sides(int orientation) { return orientation >= 5; }

/// The upright picture of a stored one, or a map of it.
Image<uint8_t> apply_orientation(Image<uint8_t> stored, int orientation);
ImageF apply_orientation(ImageF stored, int orientation);

}  // namespace aligngs
