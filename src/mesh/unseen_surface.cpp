#include "mesh/unseen_surface.h"

#include <algorithm>
#include <cstdint>

#include "metrics/visibility.h"

namespace aligngs {

size_t remove_unseen_surface(TriangleMesh& mesh, const std::vector<Camera>& cameras, double tolerance,
                             ThreadPool& pool) {
  constexpr size_t kSeenGrain = 1024;  // vertices per chunk
  if (cameras.empty() || mesh.triangles.empty()) return 0;
  const RayScene rays(mesh);
  std::vector<uint8_t> seen(mesh.vertices.size(), 0);
  pool.parallel_for(seen.size(), kSeenGrain, [&](size_t begin, size_t end, int) {
    for (size_t v = begin; v < end; ++v) {
      const Vec3d place = mesh.vertices[v].cast<double>();
      seen[v] = std::any_of(cameras.begin(), cameras.end(), [&](const Camera& camera) {
        return project_into_image(camera, place) && rays.sees(camera.centre(), place, tolerance);
      });
    }
  });
  std::vector<uint8_t> keep;
  for (const auto& t : mesh.triangles) keep.push_back(seen[t[0]] || seen[t[1]] || seen[t[2]]);
  const size_t removed = static_cast<size_t>(std::count(keep.begin(), keep.end(), uint8_t(0)));
  if (removed > 0) mesh = keep_triangles(mesh, keep);
  return removed;
}

}  // namespace aligngs
