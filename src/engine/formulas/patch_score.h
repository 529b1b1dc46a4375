// Agreement of a photo's patch with another photo across a pixel's plane: 1 - NCC^2 and its derivative by the plane
// (PGSR, Chen et al. 2024).
#pragma once

#include "engine/formulas/two_views.h"

namespace aligngs {

inline constexpr int kPatchRadius = 3;  ///< pixels: patches of 7 x 7
inline constexpr int kPatchSide = 2 * kPatchRadius + 1, kPatchPixels = kPatchSide * kPatchSide;
/// added to the product of the variances: flat patches score badly
inline constexpr double kPatchVarianceFloor = 1e-8;
inline constexpr double kPatchScoreMax = 0.9;  ///< a worse score says that the patches show different things

/// The value that patches compare: the luma of ITU-R BT.601, as published.
ALIGNGS_HD inline float grey_of(float red, float green, float blue) {
  return 0.299f * red + 0.587f * green + 0.114f * blue;
}

/// The blended plane of a pixel: N . x = -D with N and D not divided by alpha, which cancels.
template <class T>
struct BlendedPlane {
  Vec3<T> normal;
  T distance{}, alpha{};
};

template <class T>
struct PatchScore {
  bool used = false;  ///< score < kPatchScoreMax and every sample is in both images
  T score{};          ///< 1 - NCC^2, in [0, 1]
  Vec3<T> d_normal;   ///< d score / d N
  T d_distance{};     ///< d score / d D
};

/// Grey images of both views, one channel; the other one is sampled between pixel centres.
template <class T>
struct GreyImages {
  const T* grey = nullptr;
  const T* other = nullptr;
};

namespace detail {

/// The rays (z = 1) around a pixel meet the plane m . x = -1. The points, seen by the other camera and divided by the
/// depth in this one, are H r with H = R - t m^T. They are affine in the offset from the pixel.
template <class T>
struct PatchWarp {
  Vec3<T> centre, step_x, step_y;
  T slope{}, slope_x{}, slope_y{};  ///< of m . r = -1 / z in the same form
  ALIGNGS_HD PatchWarp(const TwoViews<T>& views, const Vec3<T>& m, const Vec3<T>& ray) {
    slope = dot(m, ray);
    slope_x = m.x / views.image.fx;
    slope_y = m.y / views.image.fy;
    centre = views.rotation * ray - views.translation * slope;
    step_x = views.rotation.column(0) * (T(1) / views.image.fx) - views.translation * slope_x;
    step_y = views.rotation.column(1) * (T(1) / views.image.fy) - views.translation * slope_y;
  }
  ALIGNGS_HD Vec3<T> at(T i, T j) const { return centre + step_x * i + step_y * j; }
  /// The plane is in front of both cameras and the other image contains the point.
  ALIGNGS_HD bool lands(const PinholeImage<T>& other, T i, T j) const {
    const Vec3<T> there = at(i, j);
    return slope + slope_x * i + slope_y * j < T(0) && there.z > T(kOtherDepthMin) &&
           between_centres(other, other.project(there));
  }
  /// Within the pixel centres, so that no sample needs a pixel that is not there.
  ALIGNGS_HD static bool between_centres(const PinholeImage<T>& image, const Vec2<T>& q) {
    return q.x >= T(0.5) && q.y >= T(0.5) && q.x <= T(image.width) - T(0.5) && q.y <= T(image.height) - T(0.5);
  }
};

/// sample_bilinear between pixel centres without its care for borders: value and derivatives alone.
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE Vec3<T> sample_between(const T* map, int width, int height, T q_x, T q_y) {
  const T u = q_x - T(0.5), v = q_y - T(0.5);
  int x = static_cast<int>(u), y = static_cast<int>(v);  // rounding may still have left the last pixel by an ulp
  x = x < width - 2 ? x : width - 2;
  y = y < height - 2 ? y : height - 2;
  const T a = u - T(x), b = v - T(y);
  const T* above = map + (static_cast<size_t>(y) * width + x);
  const T* below = above + width;
  const T top = above[1] - above[0], bottom = below[1] - below[0];
  const T left = above[0] + a * top, right = below[0] + a * bottom;
  return {left + b * (right - left), top + b * (bottom - top), right - left};
}

}  // namespace detail

/// Not used: patches next to the border of this image, or with a corner that is not between pixel centres of the other
/// one. Not used either: planes at no distance or without coverage, patches without contrast, and values that are not
/// numbers. The same holds for planes seen at less than kPlaneSlopeMin, where the depth does not follow the normal.
template <class T>
ALIGNGS_HD inline PatchScore<T> patch_score(const TwoViews<T>& views, const GreyImages<T>& images,
                                            const BlendedPlane<T>& plane, int x, int y) {
  const PinholeImage<T>& image = views.image;
  if (views.other.width < 2 || views.other.height < 2) return {};
  if (x < kPatchRadius || y < kPatchRadius || x + kPatchRadius >= image.width || y + kPatchRadius >= image.height)
    return {};
  if (!(plane.alpha > T(0)) || !(plane.distance > T(0))) return {};
  const Vec3<T> centre{(T(x) + T(0.5) - image.cx) / image.fx, (T(y) + T(0.5) - image.cy) / image.fy, T(1)};
  if (!(-dot(plane.normal, centre) > T(kPlaneSlopeMin) * plane.alpha * norm(centre))) return {};
  const Vec3<T> m = plane.normal * (T(1) / plane.distance);
  const detail::PatchWarp<T> warp(views, m, centre);
  const PinholeImage<T>& other = views.other;
  // what holds at the corners holds between them: all is affine, images are convex
  constexpr T kReach = T(kPatchRadius);
  if (!warp.lands(other, -kReach, -kReach) || !warp.lands(other, kReach, -kReach) ||
      !warp.lands(other, -kReach, kReach) || !warp.lands(other, kReach, kReach)) {
    return {};
  }

  // Samples, and their derivatives along -t (m . r): d sample / d m = -along r.
  T here[kPatchPixels], sample[kPatchPixels], along[kPatchPixels];
  T mean_here = T(0), mean_sample = T(0);
  for (int j = -kPatchRadius, k = 0; j <= kPatchRadius; ++j) {
    const T* row = images.grey + static_cast<size_t>(y + j) * image.width + x;
    for (int i = -kPatchRadius; i <= kPatchRadius; ++i, ++k) {
      const Vec3<T> there = warp.at(T(i), T(j));
      const T inverse = T(1) / there.z, slope_x = there.x * inverse, slope_y = there.y * inverse;
      const Vec3<T> s = detail::sample_between(images.other, other.width, other.height, other.fx * slope_x + other.cx,
                                               other.fy * slope_y + other.cy);
      here[k] = row[i];
      sample[k] = s.x;
      along[k] = (s.y * other.fx * (views.translation.x - slope_x * views.translation.z) +
                  s.z * other.fy * (views.translation.y - slope_y * views.translation.z)) *
                 inverse;
      mean_here += here[k];
      mean_sample += sample[k];
    }
  }
  constexpr T kShare = T(1) / T(kPatchPixels);
  mean_here *= kShare;
  mean_sample *= kShare;
  T product = T(0), variance_here = T(0), variance_sample = T(0);
  for (int k = 0; k < kPatchPixels; ++k) {
    here[k] -= mean_here;
    sample[k] -= mean_sample;
    product += here[k] * sample[k];
    variance_here += here[k] * here[k];
    variance_sample += sample[k] * sample[k];
  }
  product *= kShare;
  variance_here *= kShare;
  variance_sample *= kShare;
  const T both = variance_here * variance_sample + T(kPatchVarianceFloor);
  PatchScore<T> out;
  out.score = T(1) - product * product / both;
  if (!(out.score < T(kPatchScoreMax))) return {};
  out.used = true;

  // d score / d sample_k = by_here (here_k - mean) + by_sample (sample_k - mean)
  const T by_here = T(-2) * product / both * kShare;
  const T by_sample = T(2) * product * product * variance_here / (both * both) * kShare;
  T sum = T(0), sum_x = T(0), sum_y = T(0);  // of the derivatives along the rays, and of them times the offset
  for (int j = -kPatchRadius, k = 0; j <= kPatchRadius; ++j) {
    T row = T(0);
    for (int i = -kPatchRadius; i <= kPatchRadius; ++i, ++k) {
      const T g = (by_here * here[k] + by_sample * sample[k]) * along[k];
      row += g;
      sum_x += g * T(i);
    }
    sum += row;
    sum_y += row * T(j);
  }
  const Vec3<T> d_m = -(centre * sum + Vec3<T>{sum_x / image.fx, sum_y / image.fy, T(0)});
  out.d_normal = d_m * (T(1) / plane.distance);
  out.d_distance = -dot(d_m, m) / plane.distance;
  return out;
}

}  // namespace aligngs
