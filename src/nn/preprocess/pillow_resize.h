// Pillow's resizes of 8-bit images, bit for bit.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs::nn {

/// Antialiased cubic (a = -0.5), weights in 22-bit fixed point, rounded to 8 bits between the
/// horizontal and the vertical pass. A pass is left out if the size stays.
Image<uint8_t> pillow_resize_bicubic(const Image<uint8_t>& image, int width, int height);
/// The same with a triangle in place of the cubic: BILINEAR, antialiased when shrinking.
Image<uint8_t> pillow_resize_bilinear(const Image<uint8_t>& image, int width, int height);

/// An RGBA image over a white background, as Image.alpha_composite and convert("RGB") do it; an RGB
/// or grey image as RGB.
Image<uint8_t> pillow_rgb_on_white(const Image<uint8_t>& image);

}  // namespace aligngs::nn
