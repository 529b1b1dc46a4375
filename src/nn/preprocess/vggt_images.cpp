#include "nn/preprocess/vggt_images.h"

#include <algorithm>
#include <cmath>

#include "nn/preprocess/pillow_resize.h"

namespace aligngs::nn {
namespace {

/// Python's round(value / 14) * 14: halves to the even multiple.
int to_patches(double value) { return std::max(int(std::nearbyint(value / kVggtPatch)), 1) * kVggtPatch; }

/// The image in the middle of a larger one, the smaller margin first.
Image<uint8_t> centred(const Image<uint8_t>& image, int width, int height, uint8_t fill) {
  Image<uint8_t> out(width, height, image.channels, fill);
  const int left = (width - image.width) / 2, top = (height - image.height) / 2;
  const size_t line = size_t(image.width) * size_t(image.channels);
  for (int y = 0; y < image.height; ++y) std::copy_n(image.pixel(0, y), line, out.pixel(left, top + y));
  return out;
}

constexpr uint8_t kWhite = 255, kBlack = 0;

/// Before it is cut or padded.
ImageSize resized_for_vggt(int width, int height, VggtFit fit) {
  if (fit == VggtFit::kPad && width < height) return {to_patches(width * (double(kVggtSize) / height)), kVggtSize};
  return {kVggtSize, to_patches(height * (double(kVggtSize) / width))};
}

}  // namespace

ImageSize vggt_image_size(int width, int height, VggtFit fit) {
  if (fit == VggtFit::kPad) return {kVggtSize, kVggtSize};
  return {kVggtSize, std::min(resized_for_vggt(width, height, fit).height, kVggtSize)};
}

Image<uint8_t> vggt_image(const Image<uint8_t>& photo, VggtFit fit, VggtPlacement* placement) {
  const Image<uint8_t> rgb = pillow_rgb_on_white(photo);
  const auto [width, height] = resized_for_vggt(rgb.width, rgb.height, fit);
  Image<uint8_t> out = pillow_resize_bicubic(rgb, width, height);
  VggtPlacement place{double(width) / rgb.width, double(height) / rgb.height, 0, 0};
  if (fit == VggtFit::kCrop && height > kVggtSize) {
    const int start = (height - kVggtSize) / 2;
    Image<uint8_t> middle(width, kVggtSize, 3);
    std::copy_n(out.pixel(0, start), middle.data.size(), middle.data.data());
    out = std::move(middle);
    place.offset_y = -start;
  }
  if (fit == VggtFit::kPad) {
    place.offset_x = (kVggtSize - out.width) / 2;
    place.offset_y = (kVggtSize - out.height) / 2;
    out = centred(out, kVggtSize, kVggtSize, kWhite);
  }
  if (placement) *placement = place;
  return out;
}

void vggt_common_size(std::vector<Image<uint8_t>>& images, std::vector<VggtPlacement>* placements) {
  int width = 0, height = 0;
  for (const Image<uint8_t>& image : images) {
    width = std::max(width, image.width);
    height = std::max(height, image.height);
  }
  for (size_t i = 0; i < images.size(); ++i) {
    if (placements) {
      (*placements)[i].offset_x += (width - images[i].width) / 2;
      (*placements)[i].offset_y += (height - images[i].height) / 2;
    }
    images[i] = centred(images[i], width, height, kWhite);
  }
}

VggtSquare vggt_square_image(const Image<uint8_t>& photo, int target) {
  const Image<uint8_t> rgb = pillow_rgb_on_white(photo);
  const int side = std::max(rgb.width, rgb.height);
  const int left = (side - rgb.width) / 2, top = (side - rgb.height) / 2;
  VggtSquare out;
  out.image = pillow_resize_bicubic(centred(rgb, side, side, kBlack), target, target);
  const double scale = double(target) / side;
  out.x1 = float(left * scale);
  out.y1 = float(top * scale);
  out.x2 = float((left + rgb.width) * scale);
  out.y2 = float((top + rgb.height) * scale);
  out.width = float(rgb.width);
  out.height = float(rgb.height);
  return out;
}

}  // namespace aligngs::nn
