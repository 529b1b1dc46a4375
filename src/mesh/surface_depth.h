// The depth that is fused: of what a view renders, what tells most about the surface at each pixel.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "engine/engine.h"
#include "mesh/fusion_frame.h"
#include "mesh/normal_smoothing.h"
#include "refine/plane_depth.h"

namespace aligngs {

/// Plane depth is the smooth one, for it averages planes; where planes of two surfaces are averaged, it lies on
/// neither. Median depth is always on a surface, but on that of a single Gaussian. So plane depth where both agree to
/// `agreement` (relative), else median depth. H x W, 0 where there is none.
ImageF agreeing_depth(const ImageF& plane, const ImageF& median, double agreement);

/// Prior depth where rendered depth confirms it. Training moves surfaces by less than a percent, the prior's are
/// smooth and agree between views, and training finds those that the prior misses.
struct ConfirmedDepth {
  ImageF depth;  ///< H x W: rendered + share (prior - rendered), 0 where nothing is rendered
  ImageF share;  ///< H x W in [0, 1]: 1 up to `agreement`, then evenly down to 0 at twice that
};

/// The difference is |rendered / prior - 1|. Pixels without prior depth keep their rendered one. `agreement` > 0. Both
/// maps have one size.
ConfirmedDepth confirmed_depth(const ImageF& rendered, const ImageF& prior, double agreement);

struct StructuralPlanes {
  /// |log(plane / depth)| at which a pixel is off the plane; it lies on it at up to half of that
  double reach = 0.03;
  double normal_angle = 20;  ///< degrees between the depth's own normal and the plane's
};

/// Moves depth, and normals where a frame has them, to planes of the room. It moves pixels whose label is wall, floor
/// or ceiling; the planes are fitted to such pixels of all frames. Pixels near the edge of a label, off every plane, or
/// without a label stay. Returns per frame how far each pixel was moved, H x W in [0, 1]; empty maps for frames without
/// labels. Planes are fitted to training views alone.
std::vector<ImageF> draw_to_structure(std::vector<FusionFrame>& frames, const LabelSet& labels,
                                      const StructuralPlanes& options, ThreadPool& pool);

}  // namespace aligngs
