// Two cameras that look at the same surface. Bilinear samples of the other one's maps, and the forward-backward
// reprojection of a depth between them (PGSR, Chen et al. 2024).
#pragma once

#include <cmath>

#include "core/rigid.h"
#include "core/vec.h"
#include "engine/formulas/depth_terms.h"
#include "scene/camera.h"

namespace aligngs {

/// Pixels between a pixel centre and where it comes back to; from there on the views do not see the same point.
inline constexpr double kReprojectionMax = 1;
/// Smallest depth in the other view / depth in this one: points at its very camera project anywhere. The published rule
/// is 0.1 world units in rooms of a few units.
inline constexpr double kOtherDepthMin = 0.05;

template <class T>
struct PinholeImage {
  T fx{}, fy{}, cx{}, cy{};  ///< pixels
  int width = 0, height = 0;
  PinholeImage() = default;
  explicit PinholeImage(const Camera& c)
      : fx(static_cast<T>(c.fx)),
        fy(static_cast<T>(c.fy)),
        cx(static_cast<T>(c.cx)),
        cy(static_cast<T>(c.cy)),
        width(c.width),
        height(c.height) {}
  ALIGNGS_HD Vec2<T> project(const Vec3<T>& p) const { return {fx * p.x / p.z + cx, fy * p.y / p.z + cy}; }
  /// d project / d s along dp / ds.
  ALIGNGS_HD Vec2<T> project_tangent(const Vec3<T>& p, const Vec3<T>& dp) const {
    const T inverse = T(1) / (p.z * p.z);
    return {fx * (dp.x * p.z - p.x * dp.z) * inverse, fy * (dp.y * p.z - p.y * dp.z) * inverse};
  }
  ALIGNGS_HD bool contains(const Vec2<T>& q) const {
    return q.x >= T(0) && q.y >= T(0) && q.x <= T(width) && q.y <= T(height);
  }
};

/// The other camera relative to this one: x_other = rotation x + translation.
template <class T>
struct TwoViews {
  PinholeImage<T> image, other;
  Mat3<T> rotation;
  Vec3<T> translation;
  TwoViews() = default;
  TwoViews(const Camera& camera, const Camera& other_camera) : image(camera), other(other_camera) {
    const Rigidd relative = other_camera.world_to_camera * camera.world_to_camera.inverse();
    rotation = relative.rotation.template cast<T>();
    for (int k = 0; k < 3; ++k) translation[k] = static_cast<T>(relative.translation[k]);
  }
};

/// A map between pixel centres, its derivatives by the image point in pixels, and the four pixels it comes from.
template <class T>
struct BilinearSample {
  T value{}, dx{}, dy{};
  T smallest{}, largest{};
};
/// `map` is width x height, one channel; beyond the outermost pixel centres their values go on.
template <class T, class V>
ALIGNGS_HD inline BilinearSample<T> sample_bilinear(const V* map, int width, int height, const Vec2<T>& point) {
  const T last_x = T(width - 1), last_y = T(height - 1);
  const T u = point.x - T(0.5), v = point.y - T(0.5);
  const bool inside_x = u > T(0) && u<last_x, inside_y = v> T(0) && v < last_y;
  const T x = inside_x ? u : (u > T(0) ? last_x : T(0)), y = inside_y ? v : (v > T(0) ? last_y : T(0));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = x0 + 1 < width ? x0 + 1 : x0, y1 = y0 + 1 < height ? y0 + 1 : y0;
  const T a = x - T(x0), b = y - T(y0);
  const V *above = map + static_cast<size_t>(y0) * width, *below = map + static_cast<size_t>(y1) * width;
  const T p00 = static_cast<T>(above[x0]), p10 = static_cast<T>(above[x1]);
  const T p01 = static_cast<T>(below[x0]), p11 = static_cast<T>(below[x1]);
  const T top = p00 + a * (p10 - p00), bottom = p01 + a * (p11 - p01);
  BilinearSample<T> s;
  s.value = top + b * (bottom - top);
  s.dx = inside_x ? (p10 - p00) + b * ((p11 - p01) - (p10 - p00)) : T(0);
  s.dy = inside_y ? bottom - top : T(0);
  const T low_top = p00 < p10 ? p00 : p10, low_bottom = p01 < p11 ? p01 : p11;
  const T high_top = p00 > p10 ? p00 : p10, high_bottom = p01 > p11 ? p01 : p11;
  s.smallest = low_top < low_bottom ? low_top : low_bottom;
  s.largest = high_top > high_bottom ? high_top : high_bottom;
  return s;
}

/// A depth between pixel centres is none if one of the four pixels has none. It is none, too, if they lie on both sides
/// of a discontinuity (as for the other depth terms).
template <class T>
ALIGNGS_HD inline bool continuous_depth(const BilinearSample<T>& s) {
  return s.smallest > T(0) && s.largest <= (T(1) + T(kDepthJumpShare)) * s.smallest;
}

/// phi of one pixel and what moves it.
template <class T>
struct Reprojection {
  bool valid = false;
  T distance{};  ///< phi, pixels; less than kReprojectionMax
  T slope{};     ///< d phi / dz; 0 at phi = 0, where phi has no derivative
};

/// Takes the point at depth z on the ray of image point p into the other view, and reads the depth there. Takes the
/// point at that depth on the other view's ray back. phi is the distance of its image from p. Not valid outside the
/// other image, without a depth there, or for phi >= kReprojectionMax. The other depth map is a constant. The place
/// where it is read moves with z, and the slope contains that. Values that are not numbers are not valid.
template <class T, class V>
ALIGNGS_HD inline Reprojection<T> forward_backward(const TwoViews<T>& views, const V* other_depth, T z,
                                                   const Vec2<T>& p) {
  using std::sqrt;
  const Vec3<T> ray{(p.x - views.image.cx) / views.image.fx, (p.y - views.image.cy) / views.image.fy, T(1)};
  const Vec3<T> d_there = views.rotation * ray;  // d there / dz
  const Vec3<T> there = d_there * z + views.translation;
  if (!(z > T(0)) || !(there.z > T(kOtherDepthMin) * z)) return {};
  const Vec2<T> q = views.other.project(there);
  if (!views.other.contains(q)) return {};
  const BilinearSample<T> seen = sample_bilinear<T>(other_depth, views.other.width, views.other.height, q);
  if (!continuous_depth(seen)) return {};

  const Vec2<T> dq = views.other.project_tangent(there, d_there);
  const T d_seen = seen.dx * dq.x + seen.dy * dq.y;
  const Vec3<T> other_ray = there * (T(1) / there.z);
  const Vec3<T> d_other_ray{dq.x / views.other.fx, dq.y / views.other.fy, T(0)};
  const Vec3<T> back = transpose_times(views.rotation, other_ray * seen.value - views.translation);
  const Vec3<T> d_back = transpose_times(views.rotation, other_ray * d_seen + d_other_ray * seen.value);
  if (!(back.z > T(0))) return {};
  const Vec2<T> home = views.image.project(back), d_home = views.image.project_tangent(back, d_back);
  const T x = home.x - p.x, y = home.y - p.y;
  const T distance = sqrt(x * x + y * y);
  if (!(distance < T(kReprojectionMax))) return {};
  return {true, distance, distance > T(0) ? (x * d_home.x + y * d_home.y) / distance : T(0)};
}

}  // namespace aligngs
