#include "nn/preprocess/da3_images.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "nn/preprocess/normalised_image.h"
#include "nn/preprocess/opencv_area_resize.h"
#include "nn/preprocess/opencv_cubic_resize.h"

namespace aligngs::nn {
namespace {

Image<uint8_t> rgb_of(const Image<uint8_t>& photo) {
  if (photo.channels == 3) return photo;
  Image<uint8_t> rgb(photo.width, photo.height, 3);
  const bool grey = photo.channels < 3;
  for (size_t p = 0; p < photo.pixels(); ++p) {
    const uint8_t* const from = photo.data.data() + p * size_t(photo.channels);
    for (size_t c = 0; c < 3; ++c) rgb.data[3 * p + c] = from[grey ? 0 : c];
  }
  return rgb;
}

/// Half goes up.
int nearest_multiple(int side) {
  const int below = side / kDa3Patch * kDa3Patch, above = below + kDa3Patch;
  return above - side <= side - below ? above : below;
}

Image<uint8_t> part_of(const Image<uint8_t>& image, int left, int top, int width, int height) {
  Image<uint8_t> out(width, height, image.channels);
  for (int y = 0; y < height; ++y)
    std::copy_n(image.pixel(left, top + y), size_t(width) * size_t(image.channels), out.pixel(0, y));
  return out;
}

void scale_placement(ImagePlacement& p, double across, double down) {
  p.scale_x *= across;
  p.offset_x *= across;
  p.scale_y *= down;
  p.offset_y *= down;
}

void resize(Image<uint8_t>& image, ImagePlacement& placement, int width, int height, bool cubic) {
  if (width == image.width && height == image.height) return;
  scale_placement(placement, double(width) / image.width, double(height) / image.height);
  image = cubic ? opencv_resize_cubic(image, width, height) : opencv_resize_area(image, width, height);
}

/// The middle of an image.
void cut(Image<uint8_t>& image, ImagePlacement& placement, int width, int height) {
  if (width == image.width && height == image.height) return;
  const int left = (image.width - width) / 2, top = (image.height - height) / 2;
  placement.offset_x -= left;
  placement.offset_y -= top;
  image = part_of(image, left, top, width, height);
}

/// The size after the first resize.
ImageSize scaled_for_da3(int width, int height, const Da3ImageOptions& options) {
  const int side = options.shortest_side ? std::min(width, height) : std::max(width, height);
  if (side == options.size) return {width, height};
  const double scale = double(options.size) / side;
  const auto scaled = [&](int n) { return std::max(1, int(std::lrint(n * scale))); };  // half to even
  return {scaled(width), scaled(height)};
}

/// The size after the second resize or the cut.
ImageSize whole_patches(ImageSize scaled, const Da3ImageOptions& options) {
  if (options.cropped) return {scaled.width / kDa3Patch * kDa3Patch, scaled.height / kDa3Patch * kDa3Patch};
  return {nearest_multiple(scaled.width), nearest_multiple(scaled.height)};
}

}  // namespace

ImageSize da3_image_size(int width, int height, const Da3ImageOptions& options) {
  return whole_patches(scaled_for_da3(width, height, options), options);
}

Image<uint8_t> da3_image(const Image<uint8_t>& photo, const Da3ImageOptions& options, ImagePlacement* placement) {
  if (photo.empty()) throw_bad_input({}, "photo", "it has no pixels");
  Image<uint8_t> image = rgb_of(photo);
  ImagePlacement where;
  const ImageSize scaled = scaled_for_da3(image.width, image.height, options);
  resize(image, where, scaled.width, scaled.height, scaled.width > image.width || scaled.height > image.height);
  if (std::min(image.width, image.height) < kDa3Patch / 2 ||
      (options.cropped && std::min(image.width, image.height) < kDa3Patch)) {
    throw_bad_input({}, "photo",
                    std::to_string(photo.width) + " x " + std::to_string(photo.height) +
                        " pixels are too long and narrow for the network",
                    "crop the photo");
  }
  const auto [width, height] = whole_patches({image.width, image.height}, options);
  if (options.cropped)
    cut(image, where, width, height);
  else
    resize(image, where, width, height, width > image.width || height > image.height);
  if (placement) *placement = where;
  return image;
}

void da3_common_size(std::vector<Image<uint8_t>>& images, std::vector<ImagePlacement>* placements) {
  if (images.empty()) return;
  int width = images.front().width, height = images.front().height;
  for (const Image<uint8_t>& image : images) {
    width = std::min(width, image.width);
    height = std::min(height, image.height);
  }
  for (size_t i = 0; i < images.size(); ++i) {
    ImagePlacement unused;
    cut(images[i], placements ? (*placements)[i] : unused, width, height);
  }
}

FeatureMap da3_input(const Image<uint8_t>& image) {
  FeatureMap out(image.height, image.width, 3);
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = float(image.data[i]) / 255.0f;
  normalise_unit_image(out);
  return out;
}

}  // namespace aligngs::nn
