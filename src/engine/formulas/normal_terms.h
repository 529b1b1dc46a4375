// Losses on the blended normals at one pixel. Their direction is compared with the normal that the depth map implies
// (PGSR, Chen et al. 2024) and with the prior's. Label edges have a penalty (AlignGS, Gao et al. 2025).
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "engine/formulas/depth_terms.h"

namespace aligngs {

/// |N| must exceed this share of A: below it the blended normals cancel each other, no direction is left and
/// its derivative grows without bound.
inline constexpr double kNormalCoherence = 0.1;

template <class T>
struct UnitNormal {
  Vec3<T> direction;     ///< N / |N|; zero when the pixel has no direction
  T inverse_length = 0;  ///< 1 / |N|; 0 when the pixel has no direction
  ALIGNGS_HD bool valid() const { return inverse_length > T(0); }
};

/// Direction of the blended, not normalised N: valid where A > 0.5, |N| > 0.1 A and the mask keeps the pixel.
template <class T>
ALIGNGS_HD inline UnitNormal<T> unit_normal_of(const Vec3<T>& blended, T alpha, bool pixel_counts) {
  const T length = norm(blended);
  // Selections of plain values, so that a loop over pixels can vectorise.
  const bool valid =
      (alpha > T(kPlaneAlphaLoss)) & (length > T(kNormalCoherence) * alpha) & (length - length == T(0)) & pixel_counts;
  const T inverse = valid ? T(1) / length : T(0);
  return {{valid ? blended.x * inverse : T(0), valid ? blended.y * inverse : T(0), valid ? blended.z * inverse : T(0)},
          inverse};
}

/// dL/dN given dL/d(N / |N|) = g.
template <class T>
ALIGNGS_HD inline Vec3<T> normal_gradient(const UnitNormal<T>& normal, const Vec3<T>& g) {
  return (g - normal.direction * dot(g, normal.direction)) * normal.inverse_length;
}

// ---- the normal of the depth map ----

/// The neighbours of a pixel that form the difference along one axis.
enum class FiniteDifference : uint8_t { kNone = 0, kCentral = 1, kForward = 2, kBackward = 3 };

ALIGNGS_HD inline FiniteDifference difference_of(bool before, bool after) {
  if (before && after) return FiniteDifference::kCentral;
  if (after) return FiniteDifference::kForward;
  return before ? FiniteDifference::kBackward : FiniteDifference::kNone;
}

/// How far the neighbours of a difference lie from the pixel.
struct Reach {
  int before = 0, after = 0;
};
ALIGNGS_HD inline Reach reach_of(FiniteDifference difference) {
  return {difference == FiniteDifference::kCentral || difference == FiniteDifference::kBackward ? 1 : 0,
          difference == FiniteDifference::kCentral || difference == FiniteDifference::kForward ? 1 : 0};
}

/// Horizontal and vertical difference of one pixel.
struct DepthStencil {
  FiniteDifference horizontal = FiniteDifference::kNone, vertical = FiniteDifference::kNone;
  ALIGNGS_HD bool valid() const { return horizontal != FiniteDifference::kNone && vertical != FiniteDifference::kNone; }
  ALIGNGS_HD bool central() const {
    return horizontal == FiniteDifference::kCentral && vertical == FiniteDifference::kCentral;
  }
  ALIGNGS_HD uint8_t packed() const { return static_cast<uint8_t>(int(horizontal) | int(vertical) << 2); }
  ALIGNGS_HD static DepthStencil unpack(uint8_t byte) {
    return {static_cast<FiniteDifference>(byte & 3), static_cast<FiniteDifference>(byte >> 2)};
  }
};

/// As printed: central differences wherever all five pixels have loose depth validity, so never on the border. Default:
/// tight validity. The difference is one-sided if the other neighbour is missing or lies across a depth jump (|dz| / z
/// > 5 %). It is none if both do. `depth` and `validity`: [height][width].
template <class T>
ALIGNGS_HD inline DepthStencil depth_stencil(const T* depth, const uint8_t* validity, int x, int y, int width,
                                             int height, bool as_printed) {
  const size_t centre = static_cast<size_t>(y) * width + x;
  const uint8_t least = as_printed ? kDepthLoose : kDepthTight;
  if (validity[centre] < least) return {};
  const T z = depth[centre];
  const auto joined = [&](size_t i) {
    const T jump = depth[i] - z;
    return validity[i] >= least && (as_printed || (jump < T(0) ? -jump : jump) <= T(kDepthJumpShare) * z);
  };
  const DepthStencil stencil{difference_of(x > 0 && joined(centre - 1), x + 1 < width && joined(centre + 1)),
                             difference_of(y > 0 && joined(centre - width), y + 1 < height && joined(centre + width))};
  return as_printed && !stencil.central() ? DepthStencil{} : stencil;
}

/// The inputs of the depth normal of a pixel. Neighbours are those of the stencil. An offset is the neighbour's
/// distance from the pixel, in pixels (0 where a one-sided difference uses the pixel itself).
template <class T>
struct DepthNeighbours {
  T right{}, left{}, top{}, bottom{};                              ///< depths
  T right_offset{}, left_offset{}, top_offset{}, bottom_offset{};  ///< 1 | 0, -1 | 0, -1 | 0, 1 | 0
  T used{};                                                        ///< 1 | 0
};

template <class T>
struct NormalComparison {
  T loss{};                                    ///< 1 - n . n_depth, 0 where not used
  T d_x{}, d_y{}, d_z{};                       ///< weight * dL/dN
  T d_right{}, d_left{}, d_top{}, d_bottom{};  ///< weight * dL/dz of the neighbours
};

/// The depth normal is (right - left) x (top - bottom) of the unprojected neighbours, unit, turned to the camera. The
/// pixel's ray is (ray_x, ray_y, 1), a step of one pixel changes it by step_x and step_y; `blended` is the unit normal.
/// In a form that loops over pixels can vectorise: selections of plain values, not branches.
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE NormalComparison<T> compare_normals(const DepthNeighbours<T>& in, T ray_x, T ray_y,
                                                                     T step_x, T step_y, const Vec3<T>& blended,
                                                                     T inverse_length, T weight) {
  using std::sqrt;
  const T right_x = ray_x + in.right_offset * step_x, left_x = ray_x + in.left_offset * step_x;
  const T top_y = ray_y + in.top_offset * step_y, bottom_y = ray_y + in.bottom_offset * step_y;
  const Vec3<T> across{right_x * in.right - left_x * in.left, ray_y * (in.right - in.left), in.right - in.left};
  const Vec3<T> up{ray_x * (in.top - in.bottom), top_y * in.top - bottom_y * in.bottom, in.top - in.bottom};
  const Vec3<T> product = cross(across, up);
  // The points never lie on one line (their rays do not), but their product can leave the range of T.
  const T length = sqrt(dot(product, product));
  const T measurable = length < std::numeric_limits<T>::max() ? length : T(0);
  const T divisor = measurable > T(0) ? measurable : T(1);
  const T used = measurable > T(0) ? in.used : T(0);
  const T toward = product.x * ray_x + product.y * ray_y + product.z;
  const T inverse = (toward > T(0) ? T(-1) : T(1)) / divisor;
  const Vec3<T> implied{used > T(0) ? product.x * inverse : T(0), used > T(0) ? product.y * inverse : T(0),
                        used > T(0) ? product.z * inverse : T(0)};
  const T cosine = dot(implied, blended);
  NormalComparison<T> out;
  out.loss = used * (T(1) - cosine);

  const T factor = -weight * used;  // d(1 - n . m) = -m . dn - n . dm
  const T by_length = factor * inverse_length;
  out.d_x = (implied.x - blended.x * cosine) * by_length;
  out.d_y = (implied.y - blended.y * cosine) * by_length;
  out.d_z = (implied.z - blended.z * cosine) * by_length;

  const Vec3<T> d_product = (blended - implied * cosine) * (factor * inverse);
  const Vec3<T> d_across = cross(up, d_product);  // (a x b) . d has the derivatives b x d by a
  const Vec3<T> d_up = cross(d_product, across);  // and d x a by b
  const T d_across_yz = d_across.y * ray_y + d_across.z, d_up_xz = d_up.x * ray_x + d_up.z;
  out.d_right = d_across.x * right_x + d_across_yz;
  out.d_left = -(d_across.x * left_x + d_across_yz);
  out.d_top = d_up.y * top_y + d_up_xz;
  out.d_bottom = -(d_up.y * bottom_y + d_up_xz);
  return out;
}

// ---- the penalty at label edges ----

inline constexpr double kBoundarySharpness = 100;  ///< alpha of the paper

/// 1 - sigmoid(100 (1 - cos)): 0.5 for equal normals, 0.18 at 10 degrees.
ALIGNGS_HD inline double boundary_penalty(double cosine) {
  return 1 / (1 + std::exp(kBoundarySharpness * (1 - cosine)));
}
/// Its derivative by the cosine.
ALIGNGS_HD inline double boundary_slope(double penalty) { return kBoundarySharpness * penalty * (1 - penalty); }

/// True where the surface is unbroken between a pixel with depth z and its neighbour.
template <class T>
ALIGNGS_HD inline bool unbroken_depth(T z, uint8_t validity, T neighbour, uint8_t neighbour_validity) {
  if (validity != kDepthTight || neighbour_validity != kDepthTight) return false;
  const T jump = z - neighbour;
  return (jump < T(0) ? -jump : jump) <= T(kDepthJumpShare) * z;
}

}  // namespace aligngs
