// Surface normals of a depth map by local plane fits.
#pragma once

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

struct DepthNormalOptions {
  int radius = 2;       ///< pixels; the window is (2 radius + 1)^2, 5x5 by default
  double jump = 0.05;   ///< samples that differ from the centre by more than this share of its depth are ignored
  int min_samples = 6;  ///< a pixel with fewer samples in its window, itself included, gets no normal
};

/// Camera-frame unit normals, H x W x 3, turned to the camera. (0, 0, 0) where the depth has no value or the window
/// does not determine a plane. `depth` is H x W x 1 at the size of `camera`; 0 or non-finite: no value.
///
/// A plane n . X = d seen along the ray r (z = 1) has 1 / z = (n / d) . r. The fit is hence a linear regression of
/// inverse depth over the window. Weights are the square of depth (equal relative errors).
ImageF camera_normals(const ImageF& depth, const Camera& camera, const DepthNormalOptions& options = {});

}  // namespace aligngs
