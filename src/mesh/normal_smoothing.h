// A depth map that follows the normals rendered with it: noise of the depth goes, its place and its edges stay.
#pragma once

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

struct NormalSmoothingOptions {
  /// Pixels over which depth is averaged along the surface; 0 switches smoothing off. Square root of the weight of the
  /// normals beside the depth.
  double length = 4;
  /// Log units of depth. Neighbours whose step differs by more from what the normals say belong to different surfaces:
  /// 2.5 cm at 2.5 m. With twice that, thin things melt into what they lie on (development bedroom: recall at 5 cm
  /// 0.945 instead of 0.952).
  double jump = 0.01;
  /// Log units. A pixel that the smooth surface leaves by more pulls no harder than one that it leaves by so much
  /// (Huber).
  double outlier = 0.005;
  int rounds = 3;       ///< of reweighting; the first takes the depth's own steps
  int iterations = 60;  ///< of conjugate gradients per round: their reach is as many pixels, more than `length`
};

/// Minimises, over l = log z, sum_i a_i (l_i - l0_i)^2 + length^2 sum_ij b_ij (l_i - l_j - g_ij)^2 over neighbours i,
/// j. In log depth, after Nehab et al. 2005, "Efficiently combining positions and normals". g_ij is the step of the two
/// tangent planes that meet at the border of both pixels. b_ij falls to 0 (Tukey's biweight) where the measured step
/// differs from it by `jump`.
///
/// `depth` is H x W, camera z, 0 or non-finite: no value, and stays so. `normal` is H x W x 3, camera frame, turned to
/// the camera. A pixel without one (zero, or seen at less than a cosine of 0.1) has no bonds and keeps its depth.
/// `weight`, H x W or empty (1): how much a pixel's own depth counts, >= 0.
ImageF smooth_along_normals(const ImageF& depth, const ImageF& normal, const ImageF& weight, const Camera& camera,
                            const NormalSmoothingOptions& options = {});

}  // namespace aligngs
