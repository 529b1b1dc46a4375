// Cameras of the parity data of Depth Anything 3, as arrays and as the program has them.
#pragma once

#include "nn/da3/ray_pose.h"
#include "parity_case.h"

namespace aligngs::parity {

/// Extrinsics [1, views, 3 or 4, 4], world to camera, and intrinsics [1, views, 3, 3].
std::vector<nn::NetworkCamera> cameras_of(const FloatArray& extrinsics, const FloatArray& intrinsics);
/// [views, rows, 4]; rows: 3, or 4 with 0 0 0 1 last.
std::vector<float> extrinsics_of(const std::vector<nn::NetworkCamera>& cameras, int rows);
/// [views, 3, 3].
std::vector<float> intrinsics_of(const std::vector<nn::NetworkCamera>& cameras);

/// Judges the cameras in the world of the first one, "out_extrinsics_norm", and their encodings for photos of this
/// size, pixels, under `name`.
void compare_encoded(Case& test, const std::vector<nn::NetworkCamera>& given, int64_t width, int64_t height,
                     const std::string& name);

/// Stored draws [draws, 8].
nn::RayDraws draws_of(const FloatArray& array);

}  // namespace aligngs::parity
