// One Gaussian seen by one camera: 2-D mean, conic, opacity, plane, and the pixels it can touch; with the
// derivatives next to it. EWA splatting (Zwicker et al. 2001) as in 3DGS (Kerbl et al. 2023), planes as in
// PGSR (Chen et al. 2024); constants in engine/settings.h.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/quaternion.h"
#include "engine/formulas/projection_camera.h"

namespace aligngs {

/// One row of the model, parameters as stored.
template <class T>
struct GaussianShape {
  Vec3<T> position;        ///< world
  Vec3<T> log_scale;       ///< natural logarithm of the standard deviations along the three axes
  Quaternion<T> rotation;  ///< any length; zero is the identity
  T opacity_logit{};
};

/// A symmetric 2x2 matrix.
template <class T>
struct Symmetric2 {
  T xx{}, xy{}, yy{};
};

enum class ProjectionStatus : uint8_t {
  kVisible,
  kNonFinite,    ///< a parameter, or something computed from it, is NaN or infinite
  kBehind,       ///< z <= near plane
  kTransparent,  ///< opacity < alpha_min: no pixel could reach the threshold
  kDropped,      ///< left out of this step (OpacityDropout); project() itself does not know the row
  kDegenerate,   ///< determinant of the 2-D covariance <= 0
  kOutside       ///< touches no pixel centre of the image
};

template <class T>
struct Projection {
  ProjectionStatus status = ProjectionStatus::kNonFinite;
  Vec2<T> mean;              ///< pixels
  Symmetric2<T> conic;       ///< inverse of the 2-D covariance, 1 / pixel^2
  Symmetric2<T> covariance;  ///< pixels^2, low-pass included
  T opacity{};               ///< sigmoid of the logit, times opacity_factor
  T opacity_factor = T(1);   ///< of OpacityDropout
  T z{};                     ///< camera-frame depth of the centre; blending order
  Vec3<T> normal;            ///< camera frame, unit, turned to the camera: -normal . p_c >= 0
  T distance{};              ///< d = -normal . p_c >= 0; a point x of the plane has normal . x = -d
  T z_min{}, z_max{};        ///< bounds of the intersection depth: z -+ 3 largest standard deviations
  T radius{};                ///< 3 standard deviations along the longer axis, pixels
  IntegerRect pixels;        ///< every pixel that can reach alpha_min, clipped to the image
  int normal_axis = 0;       ///< which axis is the normal: the smallest scale, lowest index wins ties
  ALIGNGS_HD bool visible() const { return status == ProjectionStatus::kVisible; }
};

/// dL / d projection: what blending gives back per Gaussian.
template <class T>
struct ProjectionGradient {
  Vec2<T> mean;
  Symmetric2<T> conic;  ///< xy counted once, as in the exponent of blending.h
  T opacity{};
  Vec3<T> normal;
  T distance{};
};

/// The same with the covariance in place of the conic, for engines that blend in whitened coordinates (whitened.h).
template <class T>
struct CovarianceGradient {
  Vec2<T> mean;
  Symmetric2<T> covariance;  ///< xy counted once
  T opacity{};
  Vec3<T> normal;
  T distance{};
};

/// dL / d parameters of one row.
template <class T>
struct ShapeGradient {
  Vec3<T> position;
  Vec3<T> log_scale;
  T rotation[4]{};  ///< w x y z, of the stored (not normalised) quaternion
  T opacity_logit{};
};

namespace projection_detail {

/// Intermediate values shared by both directions. V = R_wc R are the axes in the camera frame, and J is the Jacobian of
/// the perspective map at the clamped slopes. Column k of J V S is (u[k], v[k]). The 2-D covariance is the Gram matrix
/// of these two rows plus the low-pass.
template <class T>
struct GaussianFrame {
  Quaternion<T> rotation;  ///< unit
  Mat3<T> axes;            ///< V, columns are the Gaussian's axes in the camera frame
  Vec3<T> centre;          ///< p_c
  Vec3<T> scale;
  T slope_x{}, slope_y{};
  bool clamped_x = false, clamped_y = false;
  Vec3<T> u, v;
};

template <class T>
ALIGNGS_HD inline GaussianFrame<T> make_frame(const GaussianShape<T>& g, const ProjectionCamera<T>& camera,
                                              const Vec3<T>& centre) {
  using std::exp;
  GaussianFrame<T> f;
  f.rotation = normalized(g.rotation);
  f.axes = camera.rotation * rotation_matrix(f.rotation);
  f.centre = centre;
  f.scale = {exp(g.log_scale.x), exp(g.log_scale.y), exp(g.log_scale.z)};
  const T slope_x = centre.x / centre.z, slope_y = centre.y / centre.z;
  f.slope_x = clamp_to(slope_x, camera.slope_x_min, camera.slope_x_max);
  f.slope_y = clamp_to(slope_y, camera.slope_y_min, camera.slope_y_max);
  f.clamped_x = f.slope_x != slope_x;
  f.clamped_y = f.slope_y != slope_y;
  const T zoom_x = camera.fx / centre.z, zoom_y = camera.fy / centre.z;
  for (int k = 0; k < 3; ++k) {
    f.u[k] = f.scale[k] * zoom_x * (f.axes(0, k) - f.slope_x * f.axes(2, k));
    f.v[k] = f.scale[k] * zoom_y * (f.axes(1, k) - f.slope_y * f.axes(2, k));
  }
  return f;
}

/// Pixels whose centres i + 0.5 lie within `extent` of `mean`, clipped to [0, size). Clamped as a number
/// before it becomes an integer, so that no value overflows.
template <class T>
ALIGNGS_HD inline void pixel_range(T mean, T extent, int size, int& first, int& end) {
  using std::ceil;
  using std::floor;
  first = static_cast<int>(clamp_to(ceil(mean - extent - T(0.5)), T(0), T(size)));
  end = static_cast<int>(clamp_to(floor(mean + extent - T(0.5)) + T(1), T(0), T(size)));
}

/// dL/dq of a unit quaternion from dL/dR, then through q / |q| to the stored quaternion. Zero for a
/// quaternion without a direction.
template <class T>
ALIGNGS_HD inline void rotation_backward(const Quaternion<T>& stored, const Quaternion<T>& q, const Mat3<T>& g,
                                         T* out) {
  const T length = norm(stored);
  if (!(length > T(0)) || !is_finite(length)) {
    out[0] = out[1] = out[2] = out[3] = T(0);
    return;
  }
  const T dw = T(2) * (q.z * (g(1, 0) - g(0, 1)) + q.y * (g(0, 2) - g(2, 0)) + q.x * (g(2, 1) - g(1, 2)));
  const T dx = T(2) * (q.y * (g(0, 1) + g(1, 0)) + q.z * (g(0, 2) + g(2, 0)) + q.w * (g(2, 1) - g(1, 2)) -
                       T(2) * q.x * (g(1, 1) + g(2, 2)));
  const T dy = T(2) * (q.x * (g(0, 1) + g(1, 0)) + q.z * (g(1, 2) + g(2, 1)) + q.w * (g(0, 2) - g(2, 0)) -
                       T(2) * q.y * (g(0, 0) + g(2, 2)));
  const T dz = T(2) * (q.x * (g(0, 2) + g(2, 0)) + q.y * (g(1, 2) + g(2, 1)) + q.w * (g(1, 0) - g(0, 1)) -
                       T(2) * q.z * (g(0, 0) + g(1, 1)));
  const T along = q.w * dw + q.x * dx + q.y * dy + q.z * dz;
  const T s = T(1) / length;
  out[0] = (dw - along * q.w) * s;
  out[1] = (dx - along * q.x) * s;
  out[2] = (dy - along * q.y) * s;
  out[3] = (dz - along * q.z) * s;
}

}  // namespace projection_detail

/// Projects one Gaussian. On any status but kVisible the other fields are not to be used.
///
/// Opacity-aware extent: opacity exp(-m/2) >= alpha_min inside the ellipse m <= level = 2 ln(opacity / alpha_min),
/// whose bounding box has the half extents sqrt(level cov_xx), sqrt(level cov_yy). The box is widened a little for
/// rounding: it only bounds the work, the alpha test of blending.h alone decides.
template <class T>
ALIGNGS_HD inline Projection<T> project(const GaussianShape<T>& g, const ProjectionCamera<T>& camera,
                                        const RasterSettings& settings) {
  using std::exp;
  using std::log;
  using std::sqrt;
  Projection<T> out;
  const T rotation_sum = g.rotation.w + g.rotation.x + g.rotation.y + g.rotation.z;
  if (!is_finite(g.position) || !is_finite(g.log_scale) || !is_finite(rotation_sum) || !is_finite(g.opacity_logit)) {
    return out;
  }
  const Vec3<T> centre = camera.rotation * g.position + camera.translation;
  out.z = centre.z;
  if (!is_finite(centre)) return out;
  if (centre.z <= T(settings.near_plane)) {
    out.status = ProjectionStatus::kBehind;
    return out;
  }
  out.opacity_factor = T(settings.dropout.factor());
  out.opacity = out.opacity_factor / (T(1) + exp(-g.opacity_logit));
  if (out.opacity < T(settings.alpha_min)) {
    out.status = ProjectionStatus::kTransparent;
    return out;
  }

  const projection_detail::GaussianFrame<T> f = projection_detail::make_frame(g, camera, centre);
  out.mean = {camera.fx * (centre.x / centre.z) + camera.cx, camera.fy * (centre.y / centre.z) + camera.cy};
  const T low_pass = T(settings.low_pass);
  const T uu = dot(f.u, f.u), vv = dot(f.v, f.v);
  out.covariance = {uu + low_pass, dot(f.u, f.v), vv + low_pass};
  // |u x v|^2 = uu vv - (u.v)^2 without its cancellation: a needle keeps its width in float.
  const Vec3<T> area = cross(f.u, f.v);
  const T det = dot(area, area) + low_pass * (uu + vv) + low_pass * low_pass;
  if (!is_finite(det) || !is_finite(out.mean.x) || !is_finite(out.mean.y)) return out;
  if (det <= T(0)) {
    out.status = ProjectionStatus::kDegenerate;
    return out;
  }
  out.conic = {out.covariance.yy / det, -out.covariance.xy / det, out.covariance.xx / det};

  // The normal: V's column of the smallest scale, turned so that it looks at the camera.
  out.normal_axis = g.log_scale.y < g.log_scale.x ? 1 : 0;
  if (g.log_scale.z < g.log_scale[out.normal_axis]) out.normal_axis = 2;
  const Vec3<T> axis = f.axes.column(out.normal_axis);
  const T facing = -dot(axis, centre);
  out.normal = facing >= T(0) ? axis : -axis;
  out.distance = facing >= T(0) ? facing : -facing;

  T largest = f.scale.x;
  if (f.scale.y > largest) largest = f.scale.y;
  if (f.scale.z > largest) largest = f.scale.z;
  const T reach = T(3) * largest;
  out.z_max = centre.z + reach;
  out.z_min = centre.z - reach > T(settings.near_plane) ? centre.z - reach : T(settings.near_plane);

  const T half_sum = T(0.5) * (out.covariance.xx + out.covariance.yy);
  const T half_difference = T(0.5) * (out.covariance.xx - out.covariance.yy);
  out.radius = T(3) * sqrt(half_sum + sqrt(half_difference * half_difference + out.covariance.xy * out.covariance.xy));

  const T level = T(2) * log(out.opacity / T(settings.alpha_min));
  const T widen = T(1.0001), margin = T(1e-3);  // relative and pixels: above float rounding, below any cost
  projection_detail::pixel_range(out.mean.x, widen * sqrt(level * out.covariance.xx) + margin, camera.width,
                                 out.pixels.x0, out.pixels.x1);
  projection_detail::pixel_range(out.mean.y, widen * sqrt(level * out.covariance.yy) + margin, camera.height,
                                 out.pixels.y0, out.pixels.y1);
  if (!is_finite(out.conic.xx + out.conic.xy + out.conic.yy) || !is_finite(out.radius) || !is_finite(out.distance) ||
      !is_finite(out.z_max)) {
    return out;
  }
  out.status = out.pixels.empty() ? ProjectionStatus::kOutside : ProjectionStatus::kVisible;
  return out;
}

/// Gradient of the parameters from the gradient of the projection, for a visible Gaussian. Not differentiated: the
/// choice of the normal's axis and sign, the pixel range, z (an order), z_min and z_max. Slopes that the guard band
/// clamps are not differentiated either.
///
/// C = Gram(u, v) + low-pass: du = 2 dC_xx u + dC_xy v, dv = 2 dC_yy v + dC_xy u. u_k = s_k (fx / z)(V_0k - slope_x
/// V_2k), so dL/d(log s_k) = du_k u_k + dv_k v_k. Only the opacity with its factor, normal and normal_axis of `p` are
/// read.
template <class T>
ALIGNGS_HD inline ShapeGradient<T> project_backward(const GaussianShape<T>& g, const ProjectionCamera<T>& camera,
                                                    const Projection<T>& p, const CovarianceGradient<T>& d) {
  const Vec3<T> centre = camera.rotation * g.position + camera.translation;
  const projection_detail::GaussianFrame<T> f = projection_detail::make_frame(g, camera, centre);
  ShapeGradient<T> out;
  out.opacity_logit = d.opacity * p.opacity * (T(1) - p.opacity / p.opacity_factor);

  const T dxx = d.covariance.xx, dxy = d.covariance.xy, dyy = d.covariance.yy;
  const T inverse_z = T(1) / centre.z;
  const T zoom_x = camera.fx * inverse_z, zoom_y = camera.fy * inverse_z;
  Mat3<T> daxes;
  Vec3<T> dcentre;
  T dslope_x = T(0), dslope_y = T(0);
  for (int k = 0; k < 3; ++k) {
    const T du = T(2) * dxx * f.u[k] + dxy * f.v[k];
    const T dv = T(2) * dyy * f.v[k] + dxy * f.u[k];
    out.log_scale[k] = du * f.u[k] + dv * f.v[k];
    dcentre.z -= (du * f.u[k] + dv * f.v[k]) * inverse_z;
    const T gu = du * f.scale[k] * zoom_x, gv = dv * f.scale[k] * zoom_y;
    daxes(0, k) = gu;
    daxes(1, k) = gv;
    daxes(2, k) = -gu * f.slope_x - gv * f.slope_y;
    dslope_x -= gu * f.axes(2, k);
    dslope_y -= gv * f.axes(2, k);
  }
  // Slopes of the Jacobian (zero where clamped) and of the mean, which share t_x / t_z.
  const T slope_x = centre.x * inverse_z, slope_y = centre.y * inverse_z;
  const T gx = (f.clamped_x ? T(0) : dslope_x) + d.mean.x * camera.fx;
  const T gy = (f.clamped_y ? T(0) : dslope_y) + d.mean.y * camera.fy;
  dcentre.x += gx * inverse_z;
  dcentre.y += gy * inverse_z;
  dcentre.z -= (gx * slope_x + gy * slope_y) * inverse_z;

  // Plane: d = -n . p_c and n = +-V(:, axis).
  const Vec3<T> dnormal = d.normal - d.distance * centre;
  dcentre -= d.distance * p.normal;
  const T sign = dot(p.normal, f.axes.column(p.normal_axis)) >= T(0) ? T(1) : T(-1);
  for (int r = 0; r < 3; ++r) daxes(r, p.normal_axis) += sign * dnormal[r];

  out.position = transpose_times(camera.rotation, dcentre);
  projection_detail::rotation_backward(g.rotation, f.rotation, transpose(camera.rotation) * daxes, out.rotation);
  return out;
}

/// The same from the gradient of the conic A = C^-1: dC = -A G A with G the symmetric gradient of A.
template <class T>
ALIGNGS_HD inline ShapeGradient<T> project_backward(const GaussianShape<T>& g, const ProjectionCamera<T>& camera,
                                                    const Projection<T>& p, const ProjectionGradient<T>& d) {
  const Symmetric2<T>& a = p.conic;
  const T gxx = d.conic.xx, gxy = T(0.5) * d.conic.xy, gyy = d.conic.yy;
  const T h00 = a.xx * gxx + a.xy * gxy, h01 = a.xx * gxy + a.xy * gyy;  // A G
  const T h10 = a.xy * gxx + a.yy * gxy, h11 = a.xy * gxy + a.yy * gyy;
  CovarianceGradient<T> c;
  c.mean = d.mean;
  c.covariance.xx = -(h00 * a.xx + h01 * a.xy);
  c.covariance.yy = -(h10 * a.xy + h11 * a.yy);
  c.covariance.xy = -(h00 * a.xy + h01 * a.yy) - (h10 * a.xx + h11 * a.xy);
  c.opacity = d.opacity;
  c.normal = d.normal;
  c.distance = d.distance;
  return project_backward(g, camera, p, c);
}

}  // namespace aligngs
