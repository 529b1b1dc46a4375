#include "edit/seen_surface.h"

#include <algorithm>

#include "metrics/visibility.h"

namespace aligngs {

std::vector<uint8_t> seen_from(const std::vector<Camera>& cameras, const std::vector<Vec3f>& points,
                               const TriangleMesh& surface, ThreadPool& pool) {
  constexpr double kTolerance = 0.005;  // metres: the surface a point lies on does not hide it
  constexpr size_t kGrain = 256;        // points per chunk
  std::vector<uint8_t> seen(points.size(), 0);
  if (cameras.empty()) return seen;
  const RayScene rays(surface);
  pool.parallel_for(points.size(), kGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3d p = points[i].cast<double>();
      seen[i] = std::any_of(cameras.begin(), cameras.end(), [&](const Camera& camera) {
        return project_into_image(camera, p) && rays.sees(camera.centre(), p, kTolerance);
      });
    }
  });
  return seen;
}

}  // namespace aligngs
