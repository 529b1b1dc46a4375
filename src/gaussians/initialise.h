// Gaussians from a point cloud.
#pragma once

#include "gaussians/gaussian_model.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct InitialiseOptions {
  int semantic_channels = 0;
  float opacity = 0.1f;       ///< initial opacity (3DGS 0.1; dense start 0.5)
  float flat_ratio = 1.0f;    ///< smallest scale / the other two; 1 = isotropic (paper); dense start 0.1
  bool use_normals = true;    ///< lay the shortest axis along the cloud's normals when there are any
  float scale_factor = 1.0f;  ///< multiplies the mean distance to the 3 nearest neighbours
  float scale_max = 0;        ///< scene units; 0 = none
};

/// scale = sqrt(mean squared distance to the 3 nearest neighbours), SH DC from the colour, semantics zero.
GaussianModel initialise_gaussians(const PointCloud& cloud, const InitialiseOptions& options);

/// One point per occupied cube of the given edge: mean position, colour, normal.
PointCloud voxel_thin(const PointCloud& cloud, double edge);

}  // namespace aligngs
