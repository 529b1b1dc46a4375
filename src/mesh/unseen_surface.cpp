#include "mesh/unseen_surface.h"

#include <algorithm>
#include <cstdint>

#include "metrics/visibility.h"

namespace aligngs {

size_t remove_unseen_surface(TriangleMesh& mesh, const std::vector<Camera>& cameras, double tolerance,
                             ThreadPool& pool) {
  if (cameras.empty() || mesh.triangles.empty()) return 0;
  const std::vector<uint8_t> seen = seen_points(RayScene(mesh), cameras, mesh.vertices, tolerance, pool);
  std::vector<uint8_t> keep;
  for (const auto& t : mesh.triangles) keep.push_back(seen[t[0]] || seen[t[1]] || seen[t[2]]);
  const size_t removed = static_cast<size_t>(std::count(keep.begin(), keep.end(), uint8_t(0)));
  if (removed > 0) mesh = keep_triangles(mesh, keep);
  return removed;
}

}  // namespace aligngs
