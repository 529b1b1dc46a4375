// The focal length that a camera wrote into its picture: a start for programs that look for cameras.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace aligngs {

/// The focal length in millimetres that would give the same picture on 35 mm film. The camera states it (EXIF 2.3, tag
/// 0xA405). Else it follows from the focal length and the pixels per millimetre of its sensor (0x920A, 0xA20E, 0xA210).
/// Empty when neither is there or they make no sense. `exif` is the content of a JPEG APP1 segment; `longer_side`:
/// pixels of the stored picture.
std::optional<double> exif_focal_35mm(std::string_view exif, int longer_side);

/// The content of an APP1 segment that states this and nothing else, rounded to whole millimetres.
std::string exif_with_focal_35mm(double millimetres);

}  // namespace aligngs
