// Turning a room into the axes of a file format.
#pragma once

#include <array>
#include <optional>

#include "core/quaternion.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// The rotation from the scene's world to y up. If the scene knows up, the shortest one that takes `up` to +y. Else
/// half a turn about x (from OpenCV's y down).
Mat3d rotation_to_y_up(const std::optional<Vec3d>& up);

/// The matrix of a root node that adds an offset and then turns as `rotation` does: rows of 4, for column vectors.
std::array<double, 16> root_matrix(const Mat3d& rotation, const Vec3d& offset);

/// Positions, orientations and spherical harmonics of a model, rotated. A caller that needs the model no longer moves it
/// here, and nothing is copied.
GaussianModel rotated(GaussianModel model, const Mat3d& rotation);

}  // namespace aligngs
