// Resizing of images and maps at pixel centres: source coordinate (x + 0.5) * source / target - 0.5.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs {

ImageF resize_bilinear(const ImageF& image, int width, int height);
/// Box-filtered when shrinking, bilinear when growing: for photographs.
ImageF resize_area(const ImageF& image, int width, int height);
/// The same of to_float(image), without that copy: a photo of 48 megapixels stays at its 144 MB.
ImageF resize_area(const Image<uint8_t>& image, int width, int height);
/// Bilinear over valid (> 0 and finite) samples that lie within `jump` relative of the nearest one; 0 = none.
/// Never invents depth across a discontinuity.
ImageF resize_depth(const ImageF& depth, int width, int height, float jump = 0.05f);
template <class T>
Image<T> resize_nearest(const Image<T>& image, int width, int height) {
  Image<T> out(width, height, image.channels);
  for (int y = 0; y < height; ++y) {
    const int sy = static_cast<int>((y + 0.5) * image.height / height);
    for (int x = 0; x < width; ++x) {
      const int sx = static_cast<int>((x + 0.5) * image.width / width);
      for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = image.at(sx, sy, c);
    }
  }
  return out;
}

}  // namespace aligngs
