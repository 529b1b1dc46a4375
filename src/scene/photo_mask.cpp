#include "scene/photo_mask.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/error.h"
#include "io/exif_orientation.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "scene/photo_fit.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr int kDark = 128;  // JPEG leaves traces of grey where black was meant

fs::path mask_at(const fs::path& masks, const fs::path& relative) {
  const fs::path stem = relative.parent_path() / relative.stem();
  const std::array<fs::path, 4> names = {fs::path(relative.string() + ".png"), fs::path(stem.string() + ".png"),
                                         relative, fs::path(stem.string() + ".jpg")};
  for (const fs::path& name : names) {
    std::error_code error;
    if (fs::is_regular_file(masks / name, error)) return masks / name;
  }
  return {};
}

/// A mask of 16 bits may hold small numbers, which a picture of 8 bits would lose.
Image<uint8_t> counted_values(const Image<uint16_t>& values) {
  Image<uint8_t> out(values.width, values.height, 1);
  for (size_t i = 0; i < out.pixels(); ++i) out.data[i] = values.data[i] > 0 ? 255 : 0;
  return out;
}

/// 255 where the pixel counts: in any colour, and opaque. A picture that is black everywhere has its mask in the alpha.
Image<uint8_t> counted(const fs::path& file) {
  if (const ImageInfo info = read_image_info(file); info.bit_depth == 16 && info.channels == 1)
    return counted_values(read_gray_png(file));
  const Image<uint8_t> picture = read_stored_image(file);
  const int least = file.extension() == ".png" || file.extension() == ".PNG" ? 1 : kDark;
  const auto bright = [&](const uint8_t* pixel) { return std::max({pixel[0], pixel[1], pixel[2]}) >= least; };
  bool any_bright = picture.channels < 4, any_clear = false;
  for (size_t i = 0; i < picture.pixels() && picture.channels == 4; ++i) {
    const uint8_t* pixel = &picture.data[4 * i];
    any_bright = any_bright || bright(pixel);
    any_clear = any_clear || pixel[3] < kDark;
  }
  const bool alpha_alone = !any_bright && any_clear;
  Image<uint8_t> out(picture.width, picture.height, 1);
  for (size_t i = 0; i < out.pixels(); ++i) {
    const uint8_t* pixel = &picture.data[i * size_t(picture.channels)];
    const bool opaque = picture.channels < 4 || pixel[3] >= kDark;
    out.data[i] = opaque && (alpha_alone || bright(pixel)) ? 255 : 0;
  }
  return out;
}

}  // namespace

fs::path find_mask(const fs::path& photo) {
  constexpr int kFoldersAround = 3;  // the photo's own, images/ and a subfolder of it
  fs::path base = fs::absolute(photo).lexically_normal().parent_path();
  for (int i = 0; i < kFoldersAround && !base.empty(); ++i, base = base.parent_path()) {
    std::error_code error;
    if (!fs::is_directory(base / kMaskFolder, error)) continue;
    const fs::path relative = fs::absolute(photo).lexically_normal().lexically_relative(base);
    if (fs::path found = mask_at(base / kMaskFolder, relative); !found.empty()) return found;
    if (i == 0) continue;
    fs::path below;  // without images/
    for (auto part = std::next(relative.begin()); part != relative.end(); ++part) below /= *part;
    if (fs::path found = mask_at(base / kMaskFolder, below); !found.empty()) return found;
  }
  return {};
}

Image<uint8_t> read_mask(const fs::path& mask, const fs::path& photo, bool upright, int width, int height) {
  const ImageInfo info = read_image_info(photo);
  Image<uint8_t> stored = counted(mask);
  const bool fits_stored = fit_photo({stored.width, stored.height, 1, 8, stored.width, stored.height, 1},
                                     info.stored_width, info.stored_height)
                               .has_value();
  const bool fits_upright =
      fit_photo({stored.width, stored.height, 1, 8, stored.width, stored.height, 1}, info.width, info.height)
          .has_value();
  if (!fits_stored && !(fits_upright && upright)) {
    throw_bad_input(mask, "size",
                    "the mask is " + std::to_string(stored.width) + " x " + std::to_string(stored.height) +
                        ", its photo " + std::to_string(info.stored_width) + " x " + std::to_string(info.stored_height),
                    "make the mask from the photo's pixels; it may be resized, not cropped");
  }
  if (fits_stored && upright) stored = apply_orientation(std::move(stored), info.orientation);
  return resize_nearest(stored, width, height);
}

}  // namespace aligngs
