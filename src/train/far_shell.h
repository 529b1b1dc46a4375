// Far background: points behind the room for pixels where a sensor measured nothing, as through windows.
#pragma once

#include <vector>

#include "engine/training_view.h"
#include "scene/measured_hull.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct FarShellSettings {
  double gap = 0.05;     ///< of the extent, between the measured room and the shell: no surface of the room lies there
  int clearance = 2;     ///< pixels: holes keep this distance from measured depth, so that small ones stay open
  int stride = 2;        ///< every so many pixels, in both directions
  double spacing = 1.2;  ///< edge of the thinning cubes in sampled pixels at the shell
};

/// The room that the prior depth of the views encloses. `depth_scales` are factors on it, one per view.
MeasuredHull measured_room(const std::vector<TrainingView>& views, const std::vector<float>& depth_scales);

/// Coloured points on the room enlarged by the gap, along rays of pixels without depth, with normals towards the
/// cameras. At most `most` points. The same for the same views.
PointCloud far_shell(const std::vector<TrainingView>& views, const MeasuredHull& room, double extent, size_t most,
                     const FarShellSettings& settings = {});

}  // namespace aligngs
