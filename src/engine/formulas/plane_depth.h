// Unbiased depth of a pixel from the blended plane (PGSR, Chen et al. 2024). The ray r (z = 1) meets the plane N . x =
// -D at z = D / (-N . r). alpha cancels because N and D are both sums of w times the Gaussians' values.
#pragma once

#include "core/vec.h"

namespace aligngs {

/// Guards: a grazing ray's plane depth is nearly unbounded.
inline constexpr double kPlaneSlopeMin = 0.1;       ///< smallest cosine between ray and plane; below it s is constant
inline constexpr double kPlaneAlphaLoss = 0.5;      ///< alpha above which the depth may enter a loss
inline constexpr double kPlaneAlphaFusion = 0.9;    ///< alpha above which the depth may be fused
inline constexpr double kPlaneExpectedBand = 0.15;  ///< relative distance allowed from the expected depth

template <class T>
struct PlaneDepth {
  T z{};  ///< 0 where there is nothing
  T dz_ddistance{};
  Vec3<T> dz_dnormal;
};

/// Guarded form: z = D / s with s = max(-N . r, 0.1 A |r|). If the maximum is the second term, s counts as a constant:
/// gradient through D only. No coverage (A <= 0) or a plane at no distance gives 0 without gradient.
template <class T>
ALIGNGS_HD inline PlaneDepth<T> plane_depth(const Vec3<T>& normal, T distance, T alpha, const Vec3<T>& ray) {
  PlaneDepth<T> out;
  if (!(alpha > T(0)) || !(distance > T(0))) return out;
  const T s = -dot(normal, ray);
  const T floor = T(kPlaneSlopeMin) * alpha * norm(ray);
  const bool clamped = !(s > floor);
  const T inverse = T(1) / (clamped ? floor : s);
  out.z = distance * inverse;
  out.dz_ddistance = inverse;
  if (!clamped) out.dz_dnormal = ray * (distance * inverse * inverse);
  return out;
}

/// True where the guarded depth may be trusted: alpha > alpha_min, and within 15 % of the alpha-normalised expected
/// depth of the intersections. `expected` is the blended, not normalised map.
template <class T>
ALIGNGS_HD inline bool plane_depth_valid(T z, T alpha, T expected, T alpha_min) {
  if (!(alpha > alpha_min) || !(z > T(0)) || !(expected > T(0))) return false;
  const T mean = expected / alpha;
  const T difference = z - mean;
  return (difference < T(0) ? -difference : difference) <= T(kPlaneExpectedBand) * mean;
}

/// The form of the paper's release, without guards: z = D / (-N . r + 1e-8). Preset `paper`.
template <class T>
ALIGNGS_HD inline PlaneDepth<T> plane_depth_paper(const Vec3<T>& normal, T distance, const Vec3<T>& ray) {
  PlaneDepth<T> out;
  const T inverse = T(1) / (-dot(normal, ray) + T(1e-8));
  out.z = distance * inverse;
  out.dz_ddistance = inverse;
  out.dz_dnormal = ray * (distance * inverse * inverse);
  return out;
}

}  // namespace aligngs
