// OpenCV's bilinear resize of 8-bit images (INTER_LINEAR), bit for bit.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs::nn {

/// Weights in 11-bit fixed point.
Image<uint8_t> opencv_resize_linear(const Image<uint8_t>& image, int width, int height);

}  // namespace aligngs::nn
