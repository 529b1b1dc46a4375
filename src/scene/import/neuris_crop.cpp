#include "scene/import/neuris_crop.h"

#include <algorithm>

namespace aligngs {

namespace {

constexpr int kWidth = 640, kHeight = 480;  // pixels
constexpr double kShareX = 1248.0 / 1296, kShareY = 936.0 / 968;

template <class T, class Sample>
Image<T> crop(const Image<T>& image, Sample sample) {
  Image<T> out(kWidth, kHeight, image.channels);
  const double w = image.width * kShareX, h = image.height * kShareY;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = (image.width - w) / 2 + (x + 0.5) * w / kWidth,
                   v = (image.height - h) / 2 + (y + 0.5) * h / kHeight;
      for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = sample(image, u, v, c);
    }
  }
  return out;
}

float bilinear(const ImageF& image, double u, double v, int c) {
  const double x = std::clamp(u - 0.5, 0.0, image.width - 1.0), y = std::clamp(v - 0.5, 0.0, image.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, image.width - 1),
            y1 = std::min(y0 + 1, image.height - 1);
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  return (image.at(x0, y0, c) * (1 - fx) + image.at(x1, y0, c) * fx) * (1 - fy) +
         (image.at(x0, y1, c) * (1 - fx) + image.at(x1, y1, c) * fx) * fy;
}
float nearest(const ImageF& image, double u, double v, int c) {
  return image.at(std::clamp(static_cast<int>(u), 0, image.width - 1),
                  std::clamp(static_cast<int>(v), 0, image.height - 1), c);
}

}  // namespace

Camera neuris_camera(const Camera& c) {
  Camera out = c;
  const double w = c.width * kShareX, h = c.height * kShareY;
  const double sx = kWidth / w, sy = kHeight / h;
  out.width = kWidth;
  out.height = kHeight;
  out.fx = c.fx * sx;
  out.fy = c.fy * sy;
  out.cx = (c.cx - (c.width - w) / 2) * sx;
  out.cy = (c.cy - (c.height - h) / 2) * sy;
  return out;
}

ImageF neuris_image(const ImageF& image) { return crop(image, bilinear); }

ImageF neuris_depth(const ImageF& depth) { return crop(depth, nearest); }

}  // namespace aligngs
