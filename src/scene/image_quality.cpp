#include "scene/image_quality.h"

#include <cmath>

#include "io/resample.h"

namespace aligngs {
namespace {

ImageF luminance(const Image<uint8_t>& image) {
  ImageF out(image.width, image.height, 1);
  for (size_t i = 0; i < out.data.size(); ++i) {
    const uint8_t* p = &image.data[i * image.channels];
    out.data[i] = image.channels >= 3 ? 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2] : p[0];
  }
  return out;
}

}  // namespace

double sharpness(const Image<uint8_t>& image, int width) {
  ImageF y = luminance(image);
  if (y.width > width) {
    const int height = static_cast<int>(std::lround(static_cast<double>(y.height) * width / y.width));
    if (height < 1) return 0;
    y = resize_area(y, width, height);
  }
  if (y.width < 3 || y.height < 3) return 0;
  double sum = 0, squares = 0;
  for (int j = 1; j + 1 < y.height; ++j) {
    for (int i = 1; i + 1 < y.width; ++i) {
      const double laplacian =
          static_cast<double>(y.at(i - 1, j)) + y.at(i + 1, j) + y.at(i, j - 1) + y.at(i, j + 1) - 4.0 * y.at(i, j);
      sum += laplacian;
      squares += laplacian * laplacian;
    }
  }
  const double count = static_cast<double>(y.width - 2) * (y.height - 2);
  return squares / count - (sum / count) * (sum / count);
}

double mean_luminance(const Image<uint8_t>& image) {
  if (image.empty()) return 0;
  const ImageF y = luminance(image);
  double sum = 0;
  for (float value : y.data) sum += value;
  return sum / static_cast<double>(y.data.size()) / 255;
}

}  // namespace aligngs
