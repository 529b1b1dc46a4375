// OpenCV's bicubic resize of 8-bit images (INTER_CUBIC, version 4.6 with vectors of 128 bits), bit for bit.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs::nn {

/// Cubic with a = -0.75, no antialiasing, edges repeated; weights in 11-bit fixed point.
Image<uint8_t> opencv_resize_cubic(const Image<uint8_t>& image, int width, int height);

}  // namespace aligngs::nn
