// VGGT's encoding of cameras: translation, quaternion (x, y, z, w), two fields of view.
#pragma once

#include <array>
#include <cstdint>

#include "nn/network_camera.h"

namespace aligngs::nn {

/// [tx, ty, tz, qx, qy, qz, qw, fov_h, fov_w], angles in radians.
using PoseEncoding = std::array<float, 9>;

using VggtCamera = NetworkCamera;

/// The rotation of a quaternion that need not have unit length; the identity for one of length 0.
std::array<double, 9> rotation_from_xyzw(const std::array<double, 4>& q);
/// Its inverse; w >= 0.
std::array<double, 4> xyzw_from_rotation(const std::array<double, 9>& r);

/// width, height: of the network's input in pixels. A field of view of 0 or less (the network's
/// ReLU) gives the focal length of the smallest angle, 1e-3 rad. One of pi or more gives a focal
/// length that is not positive, by the same formula.
VggtCamera decode_pose(const PoseEncoding& encoding, int64_t width, int64_t height);

}  // namespace aligngs::nn
