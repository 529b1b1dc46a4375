// The point cloud that a feed-forward reconstruction network leaves beside its maps.
#pragma once

#include <vector>

#include "core/random.h"
#include "scene/point_cloud.h"
#include "synth/teacher_geometry.h"

namespace aligngs {

/// One view of the network and its photo, both of the same size. Borrowed.
struct TeacherCloudView {
  const TeacherView* teacher = nullptr;
  const Image<uint8_t>* image = nullptr;  ///< 3 or 4 channels
};

/// Unprojected confident pixels of all views (the worst third of each view left out), thinned at random to 30 000
/// points.
PointCloud teacher_cloud(const std::vector<TeacherCloudView>& views, Random random);

}  // namespace aligngs
