// The pose of a camera that looks from one place at another.
#pragma once

#include "core/rigid.h"

namespace aligngs {

/// World-to-camera pose of an OpenCV camera at `eye` that looks at `target`, turned about its axis by `roll_degrees`.
/// `up` is a unit vector. Looking straight along `up` is allowed; the picture's top is then arbitrary.
Rigidd look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double roll_degrees = 0);

}  // namespace aligngs
