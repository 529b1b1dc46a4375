// Lens distortion of COLMAP's camera models, and resampling of images and maps to a pinhole camera.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "core/image.h"
#include "io/colmap.h"
#include "scene/camera.h"

namespace aligngs {

/// A camera with radial and tangential distortion (Brown's model in the form of OpenCV and COLMAP):
///   x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), y alike.
struct LensModel {
  int width = 0, height = 0;       ///< pixels
  double fx = 0, fy = 0;           ///< pixels
  double cx = 0, cy = 0;           ///< pixels; centre of the first pixel at 0.5
  std::array<double, 6> radial{};  ///< k1 .. k6
  double p1 = 0, p2 = 0;           ///< tangential

  bool distorted() const;
  /// The same camera without its distortion (and with the identity as pose).
  Camera pinhole() const;
  /// Distorted position of the normalised image point (x, y) = (X / Z, Y / Z).
  Vec2d distort(const Vec2d& p) const;
  /// Pixel of a ray (x, y, 1).
  Vec2d project(const Vec2d& p) const;
  /// The same lens for an image resized to w x h.
  LensModel resized(int w, int h) const;
};

/// SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV; anything else, a size that is not within
/// 1..65535 and focal lengths that are not positive are Error{kBadInput} naming `path` and the camera.
LensModel lens_of(const ColmapCamera& camera, const std::filesystem::path& path);

/// The lens as a camera of COLMAP's model FULL_OPENCV.
ColmapCamera colmap_camera_of(const LensModel& lens);

/// A pinhole of the lens's size and principal point whose every pixel has a source in the distorted image: the
/// smallest such scale of the focal lengths within [0.5, 2]. Error{kBadInput} naming `path` when the distortion
/// folds over (not invertible in the image) at any of these scales.
Camera undistorted_camera(const LensModel& lens, const std::filesystem::path& path);

/// Resamples to `pinhole` (pose ignored). The map's size may differ from the lens's: both cameras are scaled to
/// it, and the result has the aspect of `pinhole` with the map's width. Outside of the source: 0.
ImageF undistort_image(const ImageF& image, const LensModel& lens, const Camera& pinhole);  ///< bilinear, any channels
/// Depth along the z axis is unchanged by undistortion. Bilinear where the four samples are valid and within
/// `jump` relative of each other, else the nearest one: no flying pixels.
ImageF undistort_depth(const ImageF& depth, const LensModel& lens, const Camera& pinhole, float jump = 0.05f);
/// Nearest sample; `none` outside of the source.
Image<uint16_t> undistort_labels(const Image<uint16_t>& labels, const LensModel& lens, const Camera& pinhole,
                                 uint16_t none);

}  // namespace aligngs
