// Cameras as Depth Anything 3 encodes them: camera-to-world translation and quaternion (x, y, z, w), two fields of
// view.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/vggt_pose.h"

namespace aligngs::nn {

/// Encoding of a world-to-camera pose; the principal point does not count. width, height: of the network's input in
/// pixels.
PoseEncoding encode_da3_camera(const NetworkCamera& camera, int64_t width, int64_t height);

/// Its inverse, with the principal point in the middle. The quaternion need not have unit length. A field of view of
/// 0, or beyond pi, gives a focal length of a million half images: see da3_camera_is_plausible().
NetworkCamera decode_da3_camera(const PoseEncoding& encoding, int64_t width, int64_t height);

/// Whether all numbers are finite and both fields of view lie between 1 and 179 degrees.
bool da3_camera_is_plausible(const NetworkCamera& camera, int64_t width, int64_t height);

/// The same cameras in the frame of the first. Distances from it are divided by their lower median, at least 0.1; the
/// distance 0 of the first counts too. At least one camera; rotations are orthonormal.
std::vector<NetworkCamera> normalised_cameras(std::vector<NetworkCamera> cameras);

/// Given cameras brought to predicted ones.
struct CameraAlignment {
  double scale = 1;     ///< predicted lengths per given length: predicted depth is divided by it
  double residual = 0;  ///< root mean square distance of the centres after the fit, in predicted lengths
  /// False with fewer than three cameras, or all on a line: the rotation then comes from the cameras' own.
  bool well_posed = false;
  std::vector<NetworkCamera> cameras;  ///< the given ones in the predicted frame
};
/// Least squares over the centres (Umeyama 1991). Lists of one length, at least one camera.
CameraAlignment align_given_cameras(const std::vector<NetworkCamera>& given,
                                    const std::vector<NetworkCamera>& predicted);

}  // namespace aligngs::nn
