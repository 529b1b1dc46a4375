// Lenses of COLMAP's camera models: where a ray meets the picture.
#pragma once

#include <array>
#include <filesystem>

#include "io/colmap.h"
#include "scene/camera.h"

namespace aligngs {

/// How a ray (x, y, 1), r = |(x, y)|, meets the image plane before the polynomials of the lens bend it.
enum class LensProjection {
  kPerspective,  ///< (x, y)
  kFisheye,      ///< (x, y) theta / r, theta = atan r: equidistant (Kannala and Brandt 2006)
  kFieldOfView,  ///< (x, y) atan(2 r tan(w / 2)) / (r w), w = radial[0] (Devernay and Faugeras 2001)
  kDivision,     ///< (x, y) 2 / (1 + sqrt(1 - 4 k r^2)), k = radial[0] (Fitzgibbon 2001): undone by p / (1 + k |p|^2)
  kUnified,      ///< (x, y) / (a sqrt(b r^2 + 1) + 1 - a), a = radial[0], b = radial[1]: EUCM (Khomutenko et al. 2016)
};

/// With q the projected point and s = |q|:
/// kPerspective: q (1 + k1 s^2 + k2 s^4 + k3 s^6) / (1 + k4 s^2 + k5 s^4 + k6 s^6), Brown's model as OpenCV and COLMAP
/// have it;
///   kFisheye:     q (1 + k1 s^2 + ... + k6 s^12);
/// then tangential terms (2 p1 qx qy + p2 (s^2 + 2 qx^2), y alike with p1 and p2 exchanged) are added. Thin prism terms
/// (prism[0] s^2 + prism[1] s^4, prism[2] s^2 + prism[3] s^4) are added, too.
struct LensModel {
  LensProjection projection = LensProjection::kPerspective;
  int width = 0, height = 0;       ///< pixels
  double fx = 0, fy = 0;           ///< pixels
  double cx = 0, cy = 0;           ///< pixels; centre of the first pixel at 0.5
  std::array<double, 6> radial{};  ///< k1 .. k6, or what the projection names
  double p1 = 0, p2 = 0;           ///< tangential
  std::array<double, 4> prism{};   ///< thin prism
  /// tangential and prism terms take the radially bent point (RAD_TAN_THIN_PRISM_FISHEYE)
  bool bent_first = false;

  bool distorted() const;
  /// The same camera without its distortion (and with the identity as pose).
  Camera pinhole() const;
  /// Distorted position of the normalised image point (x, y) = (X / Z, Y / Z); nan where the lens sees no such ray.
  Vec2d distort(const Vec2d& p) const;
  /// Pixel of a ray (x, y, 1).
  Vec2d project(const Vec2d& p) const;
  /// The same lens for an image resized to w x h.
  LensModel resized(int w, int h) const;
};

/// All of COLMAP's models but EQUIRECTANGULAR, which is no view of a pinhole. Error{kBadInput} naming `path` and the
/// camera: that model, a size not within 1..65535, non-finite parameters, focal lengths that are not positive.
LensModel lens_of(const ColmapCamera& camera, const std::filesystem::path& path);

/// A camera model for images resized to w x h.
ColmapCamera resized_camera(const ColmapCamera& camera, int w, int h);

}  // namespace aligngs
