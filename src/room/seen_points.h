// Measured pixels of photos, as places with the direction that their surface faces.
#pragma once

#include <vector>

#include "core/rigid.h"
#include "core/thread_pool.h"
#include "refine/measured_planes.h"

namespace aligngs {

struct SeenPoint {
  Vec3d from, to;    ///< the camera, and the surface that a pixel shows
  Vec3d normal;      ///< unit, towards the camera; zero where the depth does not tell
  double depth = 0;  ///< along the camera's axis
};

/// The point of a pixel, without its normal. The depth must be one (core/is_depth.h).
SeenPoint seen_point(const MeasuredView& view, int x, int y, const Similarity& to_frame);

/// Normals of a view's surfaces in its camera's frame, from planes through nine by nine pixels.
ImageF surface_normals(const MeasuredView& view);

/// Every `stride`-th pixel with depth, transformed by `to_frame`; the same for any number of threads. Depth is scaled,
/// too.
std::vector<SeenPoint> seen_points(const std::vector<MeasuredView>& views, const Similarity& to_frame, int stride,
                                   ThreadPool& pool);

}  // namespace aligngs
