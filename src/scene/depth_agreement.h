// Whether depth maps of several views and their cameras have one unit and one convention, told without any other points.
#pragma once

#include <span>

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

/// How matrices or depth maps are read wrongly: all of a capture at once.
enum class Misreading {
  kNone,
  kAxes,        ///< y and z of the cameras are turned round: OpenGL's axes for OpenCV's, or the reverse
  kInverted,    ///< world-to-camera for camera-to-world, or the reverse, of any axes
  kAlongRays,   ///< distances from the camera's centre for depth along its axis
  kUpsideDown,  ///< the last row of a map is the first of its photo
};

struct DepthAgreement {
  /// Median relative difference of a view's depth and another's surface; 1 where hardly any place is seen twice.
  double difference = 0;
  size_t samples = 0;            ///< pixels that were compared for it
  double factor = 1;             ///< depth times this agrees best
  double scaled_difference = 0;  ///< the difference then
  size_t scaled_samples = 0;
  /// The reading of matrices or maps that makes depth agree without another unit; kNone where none does.
  Misreading misreading = Misreading::kNone;
  double read_difference = 0;  ///< the difference then
  /// Whether another unit explains what the depth as it is contradicts.
  bool has_other_unit() const;
  /// Whether the depth as it is contradicts itself by far, explained or not.
  bool is_contradicted() const;
};

/// Compares samples of each view with the views that see the same place. `cameras[i]` has the size of `depths[i]`, where
/// 0 is none. Cameras in one place tell nothing about the unit. Depth s times what it should be moves a surface by
/// (1 - 1/s) b / d. There d is its distance, b the part of the baseline along its normal.
DepthAgreement depth_agreement(std::span<const Camera> cameras, std::span<const ImageF> depths);

}  // namespace aligngs
