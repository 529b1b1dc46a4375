#include "nn/preprocess/normalised_image.h"

#include <algorithm>

#include "nn/preprocess/opencv_resize.h"

namespace aligngs::nn {

FeatureMap normalised_image(const Image<uint8_t>& rgb) {
  constexpr float kMean[3] = {123.675f, 116.28f, 103.53f}, kStd[3] = {58.395f, 57.12f, 57.375f};
  FeatureMap out(rgb.height, rgb.width, 3);
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = (float(rgb.data[i]) - kMean[i % 3]) / kStd[i % 3];
  return out;
}

void normalise_unit_image(FeatureMap& image) {
  constexpr float kMean[3] = {0.485f, 0.456f, 0.406f}, kStd[3] = {0.229f, 0.224f, 0.225f};
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = (image.data[i] - kMean[i % 3]) / kStd[i % 3];
}

namespace {

ImageSize kept_ratio(int width, int height, const SegmentationResize& resize) {
  const auto [low, high] = std::minmax(width, height);
  const auto [short_side, long_side] = std::minmax(resize.short_side, resize.long_side);
  const double scale = std::min(double(long_side) / high, double(short_side) / low);
  return {int(width * scale + 0.5), int(height * scale + 0.5)};
}

}  // namespace

ImageSize segmentation_size(int width, int height, const SegmentationResize& resize) {
  const ImageSize size = kept_ratio(width, height, resize);
  if (resize.multiple <= 0) return size;
  const auto up = [&](int n) { return (n + resize.multiple - 1) / resize.multiple * resize.multiple; };
  return {up(size.width), up(size.height)};
}

Image<uint8_t> segmentation_image(const Image<uint8_t>& rgb, const SegmentationResize& resize) {
  const ImageSize kept = kept_ratio(rgb.width, rgb.height, resize);
  Image<uint8_t> out = opencv_resize_linear(rgb, kept.width, kept.height);
  if (resize.multiple <= 0) return out;
  const ImageSize size = segmentation_size(rgb.width, rgb.height, resize);
  return opencv_resize_linear(out, size.width, size.height);
}

FeatureMap centre_padded(const FeatureMap& image, int64_t multiple) {
  const auto up = [&](int64_t n) { return (n + multiple - 1) / multiple * multiple; };
  FeatureMap out(up(image.height), up(image.width), image.channels);
  const int64_t top = (out.height - image.height) / 2, left = (out.width - image.width) / 2;
  for (int64_t y = 0; y < image.height; ++y)
    std::copy_n(image.at(y, 0), image.width * image.channels, out.at(top + y, left));
  return out;
}

}  // namespace aligngs::nn
