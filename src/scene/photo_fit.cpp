#include "scene/photo_fit.h"

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

/// Whether a picture of w x h can be one of camera_w x camera_h resized: the sides differ by one factor. A resized side
/// is rounded, so each may be off by one pixel of the smaller picture.
bool same_aspect(int w, int h, int camera_w, int camera_h) {
  constexpr double kMostRounding = 0.1;  // of the aspect, however small a picture is
  const double aspects = (static_cast<double>(w) * camera_h) / (static_cast<double>(h) * camera_w);
  if (std::fabs(aspects - 1) > kMostRounding) return false;
  const double scale = static_cast<double>(w) / camera_w;
  const double tolerance = 1 + std::fmax(1.0, scale);  // rounding of both sides, each of at most a pixel
  if (std::fabs(camera_h * scale - h) <= 0.5 * tolerance) return true;
  return std::fabs(static_cast<double>(camera_w) * h / camera_h - w) <= 0.5 * tolerance;
}

}  // namespace

std::optional<PhotoFit> fit_photo(const ImageInfo& photo, int camera_width, int camera_height) {
  const PhotoFit stored{false, photo.stored_width, photo.stored_height}, upright{true, photo.width, photo.height};
  for (const PhotoFit& fit : {stored, upright}) {
    if (fit.width == camera_width && fit.height == camera_height) return fit;
  }
  for (const PhotoFit& fit : {stored, upright}) {
    if (same_aspect(fit.width, fit.height, camera_width, camera_height)) return fit;
  }
  return std::nullopt;
}

PhotoFit require_photo_fit(const std::filesystem::path& file, const ImageInfo& photo, int camera_width,
                           int camera_height) {
  if (const auto fit = fit_photo(photo, camera_width, camera_height)) return *fit;
  const bool turned = same_aspect(photo.stored_height, photo.stored_width, camera_width, camera_height);
  throw_bad_input(file, "size",
                  "the image is " + size_text(photo.stored_width, photo.stored_height) + ", its camera says " +
                      size_text(camera_width, camera_height),
                  turned
                      ? "the camera is for a picture that was turned by a quarter: use the images that it was found for"
                      : "use the images that the cameras were found for; they may be resized, not cropped");
}

Image<uint8_t> read_photo(const std::filesystem::path& file, bool upright) {
  return upright ? read_image(file) : read_stored_image(file);
}

bool is_upright_of_size(const ImageInfo& photo, int width, int height) {
  return photo.stored_width != width || photo.stored_height != height;
}

Image<uint8_t> read_photo_of_size(const std::filesystem::path& file, int width, int height) {
  return read_photo(file, is_upright_of_size(read_image_info(file), width, height));
}

}  // namespace aligngs
