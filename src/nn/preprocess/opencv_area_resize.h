// OpenCV's area resize of 8-bit images (INTER_AREA when shrinking), bit for bit.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs::nn {

/// Means over the area that each new pixel covers; neither side may grow.
Image<uint8_t> opencv_resize_area(const Image<uint8_t>& image, int width, int height);

}  // namespace aligngs::nn
