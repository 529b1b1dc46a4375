// Cameras from maps of rays (Lin et al. 2025): the homography from pixels to ray directions, by RANSAC, taken apart
// into rotation and intrinsics.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "nn/network_camera.h"
#include "nn/tensor.h"

namespace aligngs::nn {

/// How a homography A = R K^-1 is taken apart.
enum class RayDecomposition {
  kUpper,     ///< A = R U with U upper triangular, as K^-1 is: right wherever the principal point lies
  kPublished  ///< A = Q L with L lower triangular, as published: right for a centred principal point only
};

/// Eight rays each, as positions in the list sorted by falling confidence.
using RayDraws = std::vector<std::array<int, 8>>;

struct RayPoseOptions {
  RayDecomposition decomposition = RayDecomposition::kUpper;
  int draws = 100;
  uint64_t seed = 1;  ///< of the draws
};

struct RayPose {
  NetworkCamera camera;
  std::array<double, 9> homography{};  ///< row-major, from canonical pixels in [-1, 1] to directions, last element +-1
  size_t inliers = 0;                  ///< rays that agree with it
};

/// The most confident rays from which draws are taken: three tenths of them, at least 8 (fewer when there are fewer).
int64_t ray_candidates(int64_t rays);
/// Equal seeds give equal draws. Error{kBadInput} for fewer than 8 rays.
RayDraws draw_rays(int64_t rays, const RayPoseOptions& options);

/// rays [h, w, 7]: direction (not unit), origin, confidence; width, height: of the image in pixels. Error{kBadInput}
/// when the rays are not those of a camera: too few, or a homography that cannot be taken apart.
RayPose pose_from_rays(const FeatureMap& rays, const RayDraws& draws, int64_t width, int64_t height,
                       const RayPoseOptions& options);
/// With draws of its own: the same for every view of that many rays.
RayPose pose_from_rays(const FeatureMap& rays, int64_t width, int64_t height, const RayPoseOptions& options = {});

}  // namespace aligngs::nn
