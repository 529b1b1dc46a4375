// Cameras and points of ours as a COLMAP model: what other programs read.
#pragma once

#include <string>

#include "io/colmap.h"
#include "scene/camera.h"
#include "scene/point_cloud.h"

namespace aligngs {

/// Adds an image with its pose; views of equal intrinsics share one PINHOLE camera. Ids count from 1.
void append_view(ColmapModel& model, const Camera& camera, const std::string& image_name);

/// Adds the points without tracks. Ids count from 1, so call it once.
void append_points(ColmapModel& model, const PointCloud& cloud);

}  // namespace aligngs
