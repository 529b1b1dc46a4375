// A dense coloured cloud with normals from depth maps of several views.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/point_cloud.h"

namespace aligngs {

/// One view's contribution. The pointers are borrowed; all maps have the size of `camera`.
struct DepthCloudView {
  Camera camera;
  const ImageF* depth = nullptr;       ///< H x W x 1, scene units; 0 or non-finite: no value
  const ImageF* color = nullptr;       ///< H x W x 3, sRGB in [0, 1]
  const ImageF* confidence = nullptr;  ///< H x W x 1 in [0, 1], or null: 1 everywhere
};

/// Parameters of the dense start from prior depth.
struct DepthCloudOptions {
  double agreement = 0.02;       ///< relative depth difference up to which another view confirms a point
  double contradiction = 0.05;   ///< a view that measures more than this share farther sees through the point
  int min_views = 2;             ///< views that must agree, the point's own included
  bool keep_single_view = true;  ///< keep unconfirmed points that no view contradicts, with `single_view_weight`
  double single_view_weight = 0.25;
  double min_confidence = 0.05;   ///< pixels below are not used
  double jump = 0.05;             ///< relative depth step to a neighbour that marks a silhouette pixel: not used
  double voxel = 0;               ///< scene units; 0: automatic, `voxel_footprints` pixel footprints at median depth
  double voxel_footprints = 1.5;  ///< voxel size in pixel footprints at the median depth
  size_t max_points = 250000;     ///< the automatic voxel grows until the cloud has at most this many; 0: no limit
  int stride = 1;                 ///< use every stride-th pixel in both directions
};

struct DepthCloud {
  PointCloud cloud;            ///< one point per voxel, with normals turned to the cameras
  std::vector<float> weights;  ///< sum of confidence over the voxel's points
  std::vector<uint8_t> views;  ///< number of views that agree on the point: 1 = seen by a single view
  double voxel = 0;            ///< edge used, scene units
};

/// Unprojects, checks between views, merges per voxel. The same result for any number of threads. Maps of wrong
/// size are Error{kFailed}; views without any valid depth contribute nothing.
DepthCloud fuse_depth_cloud(const std::vector<DepthCloudView>& views, const DepthCloudOptions& options,
                            ThreadPool& pool);

/// Median over views of (median depth / focal length): what one pixel covers, scene units; 0 without any depth.
double median_pixel_footprint(const std::vector<DepthCloudView>& views);

}  // namespace aligngs
