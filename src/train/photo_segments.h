// The Gaussians that a training photo shows inside of each of its segments.
#pragma once

#include <vector>

#include "engine/settings.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/object_votes.h"
#include "scene/camera.h"
#include "scene/segment_file.h"

namespace aligngs {

/// A photo's segments, as its camera sees the Gaussians.
struct SegmentedView {
  Camera camera;
  float near_plane = 0;  ///< scene units
  SegmentMap segments;   ///< any resolution of the camera's aspect
};

/// A Gaussian has the pixels of a segment that the photo shows of it, by blending weight (PhotoOpinion). Hidden ones
/// have none. Stuff counts as no segment. A photo without things has no sightings. The same for any number of threads.
PhotoSegments sighted_segments(const GaussianModel& model, const SegmentedView& view, const RasterSettings& raster,
                               ThreadPool& pool);

}  // namespace aligngs
