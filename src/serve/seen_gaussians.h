// The Gaussians that one camera may see: less to keep and to draw than the whole room.
#pragma once

#include "gaussians/gaussian_model.h"
#include "scene/camera.h"

namespace aligngs {

/// Rows of `model` in their order, without those that are invisible or outside of the camera's view. The camera draws
/// the same picture of them. Semantics are left out.
GaussianModel seen_gaussians(const GaussianModel& model, const Camera& camera);

}  // namespace aligngs
