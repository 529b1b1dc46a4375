// How sharp and how bright a photo is.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs {

/// Pixels: the blur of larger photos is compared at this width.
inline constexpr int kSharpnessWidth = 640;

/// Variance of the Laplacian of the luminance (0 to 255 scale), at most `width` pixels wide: larger is sharper. 0 for
/// images below 3 x 3 pixels. Compare only views of the same scene, all at the width of the narrowest.
double sharpness(const Image<uint8_t>& image, int width = kSharpnessWidth);

/// Mean luminance in [0, 1] of the sRGB values (Rec. 709 weights).
double mean_luminance(const Image<uint8_t>& image);

}  // namespace aligngs
