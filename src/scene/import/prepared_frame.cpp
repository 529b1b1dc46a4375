#include "scene/import/prepared_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "scene/import/capture_frames.h"
#include "scene/import/neuris_crop.h"
#include "scene/photo_fit.h"
#include "scene/photo_mask.h"
#include "scene/prior_maps.h"
#include "scene/undistort.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Four channels, the last one 255 where the mask (of any size) counts the pixel.
Image<uint8_t> with_mask(const Image<uint8_t>& image, const fs::path& file, const CapturedFrame& frame) {
  constexpr int kSeen = 128;  // of the image's own alpha
  const Image<uint8_t> mask = read_mask(file, frame.image, frame.upright, image.width, image.height);
  Image<uint8_t> out(image.width, image.height, 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::copy_n(image.pixel(x, y), 3, out.pixel(x, y));
      const bool seen = image.channels < 4 || image.at(x, y, 3) >= kSeen;
      out.at(x, y, 3) = mask.at(x, y) != 0 && seen ? 255 : 0;
    }
  }
  return out;
}

/// Whether the photo lost detail when it was stored, so that its copy may as well. PNG is as it was taken.
bool is_lossy(const fs::path& file) { return file.extension() != ".png" && file.extension() != ".PNG"; }

/// Whether depth fits the photo only after the turn that its EXIF orientation asks for, and which is not done.
bool is_turned_by_exif(const CapturedFrame& frame, const ImageF& depth, const Camera& camera) {
  if (frame.upright || has_same_aspect({1, depth.height, depth.width}, camera.width, camera.height)) return false;
  return has_same_aspect({1, depth.width, depth.height}, camera.width, camera.height) &&
         read_image_info(frame.image).orientation >= kFirstQuarterTurn;
}

void require_usable_depth(const CapturedFrame& frame, const ImageF& depth, const Camera& camera) {
  if (is_turned_by_exif(frame, depth, camera))
    throw_bad_input(frame.depth, "size",
                    fmt::format("{} x {} has not the aspect of its image, {} x {}, as stored", depth.width,
                                depth.height, camera.width, camera.height),
                    kTurnedByExif);
  require_same_aspect({1, depth.height, depth.width}, camera.width, camera.height, frame.depth, "size");
  if (std::none_of(depth.data.begin(), depth.data.end(), [](float z) { return z > 0; })) {
    throw_bad_input(frame.depth, "values", "no pixel has a depth", "leave this frame out");
  }
}

}  // namespace

PreparedFrame prepare_frame(const Capture& capture, const CapturedFrame& frame, const ImportOptions& options) {
  PreparedFrame out;
  const LensModel lens = lens_of(frame.camera, frame.image);
  Camera camera = lens.distorted() ? undistorted_camera(lens, frame.image) : lens.pinhole();
  out.depth = read_capture_depth(capture, frame);
  if (lens.distorted() && !out.depth.empty()) out.depth = undistort_depth(out.depth, lens, camera);
  const std::string bytes = read_file(frame.image);
  out.pixels = frame.upright ? decode_image(bytes, frame.image) : decode_stored_image(bytes, frame.image);
  const fs::path mask = frame.mask.empty() ? find_mask(frame.image) : frame.mask;
  if (!mask.empty()) out.pixels = with_mask(out.pixels, mask, frame);
  const bool common = is_common_picture(bytes, frame.image);
  const bool large = options.max_side > 0 && std::max(camera.width, camera.height) > options.max_side;
  if (lens.distorted() || options.neuris_crop || large) {
    ImageF image = to_float(out.pixels);
    if (lens.distorted()) image = undistort_image(image, lens, camera);
    if (options.neuris_crop) {
      camera = neuris_camera(camera);
      image = neuris_image(image);
      if (!out.depth.empty()) out.depth = neuris_depth(out.depth);
    }
    if (large) {
      const double scale = double(options.max_side) / std::max(camera.width, camera.height);
      camera =
          camera.resized(std::max(1, int(camera.width * scale + 0.5)), std::max(1, int(camera.height * scale + 0.5)));
      image = resize_area(image, camera.width, camera.height);
    }
    out.pixels = to_bytes(image);
  }
  if (lens.distorted() || options.neuris_crop || large || !mask.empty() || !common) {
    constexpr int kQuality = 95;  // artefacts stay below the noise of a camera
    out.parts.image = out.pixels;
    if (!lens.distorted() && is_lossy(frame.image)) out.parts.jpeg_quality = kQuality;
  } else {
    out.parts.image_file = frame.image;
  }
  if (!out.depth.empty()) require_usable_depth(frame, out.depth, camera);
  camera.world_to_camera = frame.world_to_camera;
  out.parts.name = frame.name;
  out.parts.camera = camera;
  return out;
}

}  // namespace aligngs
