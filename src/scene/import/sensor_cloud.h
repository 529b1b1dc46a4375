// The points to start from where a capture has depth of a sensor.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/point_cloud.h"

namespace aligngs {

/// Keeps what the cloud needs of each training view.
class SensorCloud {
 public:
  /// `depth` may be smaller than the picture of `camera`. Pixels that the alpha of `pixels` hides have no depth.
  void add(const Camera& camera, const ImageF& depth, const Image<uint8_t>& pixels);
  bool empty() const { return cameras_.empty(); }
  /// A warning where something speaks against the depth (scene/depth_contradiction.h), else empty. `unit`: scene units
  /// per stored value.
  std::string contradiction(bool metric, double unit, const PointCloud& points) const;
  PointCloud fuse(double voxel, ThreadPool& pool) const;

 private:
  std::vector<Camera> cameras_;  ///< at the size of the depth
  std::vector<ImageF> depths_, colors_;
};

}  // namespace aligngs
