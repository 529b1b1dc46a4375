// First hits of cameras on a surface, kept: several protocols look at the same surface through the same cameras.
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "metrics/visibility.h"
#include "scene/camera.h"

namespace aligngs {

/// The part of a surface that one camera sees.
struct CameraHits {
  std::vector<uint32_t> triangles;  ///< each once, in the order of the pixels
  Image<uint8_t> hit;               ///< H x W, 1 where something is hit
};

/// Casts the rays of a camera when they are asked for the first time. The same results as RayScene::cast().
class HitCache {
 public:
  /// The cameras have the resolution of the rays. References must outlive the cache.
  HitCache(const RayScene& rays, size_t triangles, const std::vector<Camera>& cameras, ThreadPool& pool)
      : rays_(rays), triangles_(triangles), cameras_(cameras), pool_(pool) {}

  /// `there`, per triangle: rays pass through those marked 0. The reference lasts as long as the cache.
  const CameraHits& of(size_t camera, const std::vector<uint8_t>& there);
  /// Per triangle 1 when some of the cameras hits it.
  std::vector<uint8_t> seen(const std::vector<size_t>& cameras, const std::vector<uint8_t>& there);

 private:
  struct Looks {
    std::vector<uint8_t> there;
    std::vector<std::optional<CameraHits>> of_camera;
  };
  Looks& looks(const std::vector<uint8_t>& there);

  const RayScene& rays_;
  size_t triangles_;
  const std::vector<Camera>& cameras_;
  ThreadPool& pool_;
  std::list<Looks> looks_;
};

}  // namespace aligngs
