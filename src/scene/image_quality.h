// How sharp and how bright a photo is.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs {

/// Variance of the Laplacian of the luminance (0 to 255 scale), at most 640 pixels wide so that sizes compare:
/// larger is sharper. 0 for images below 3 x 3 pixels. Compare only views of the same scene.
double sharpness(const Image<uint8_t>& image);

/// Mean luminance in [0, 1] of the sRGB values (Rec. 709 weights).
double mean_luminance(const Image<uint8_t>& image);

}  // namespace aligngs
