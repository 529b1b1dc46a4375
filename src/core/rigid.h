// Rigid motions and similarities of space.
#pragma once

#include <vector>

#include "core/quaternion.h"

namespace aligngs {

/// x -> rotation * x + translation.
template <class T>
struct Rigid {
  Mat3<T> rotation = Mat3<T>::identity();
  Vec3<T> translation;

  ALIGNGS_HD Vec3<T> operator*(const Vec3<T>& x) const { return rotation * x + translation; }
  ALIGNGS_HD Rigid operator*(const Rigid& b) const {
    return {rotation * b.rotation, rotation * b.translation + translation};
  }
  ALIGNGS_HD Rigid inverse() const {
    const Mat3<T> rt = transpose(rotation);
    return {rt, -(rt * translation)};
  }
};
using Rigidd = Rigid<double>;

/// x -> scale * rotation * x + translation.
struct Similarity {
  double scale = 1;
  Mat3d rotation = Mat3d::identity();
  Vec3d translation;

  Vec3d operator*(const Vec3d& x) const { return scale * (rotation * x) + translation; }
  Similarity inverse() const;
  /// World-to-camera pose in the transformed world (camera units scale with the world).
  Rigidd transform_world_to_camera(const Rigidd& world_to_camera) const;
};

/// The similarity that takes `from` to `to` in the least-squares sense (Umeyama 1991).
struct SimilarityFit {
  Similarity similarity;
  double rmse = 0;  ///< root mean squared residual, in units of `to`
  /// false with fewer than 3 points or all on one line: scale and rotation are not determined
  bool well_posed = false;
};
SimilarityFit fit_similarity(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, bool with_scale = true);

/// Like fit_similarity, but the rotation is the mean of camera rotations: works for 1 or 2 cameras
/// and for cameras on a line. Poses are world-to-camera of the same cameras in the two worlds.
SimilarityFit fit_similarity_of_cameras(const std::vector<Rigidd>& from, const std::vector<Rigidd>& to);

/// Angle of the rotation a * b^T, in degrees.
double rotation_angle_between_degrees(const Mat3d& a, const Mat3d& b);

}  // namespace aligngs
