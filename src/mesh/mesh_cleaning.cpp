#include "mesh/mesh_cleaning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

struct Size {
  double area = 0;
  size_t triangles = 0;
  Vec3f low{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
            std::numeric_limits<float>::infinity()};
  Vec3f high = -low;

  void add(const TriangleMesh& mesh, size_t triangle) {
    area += triangle_area(mesh, triangle);
    ++triangles;
    for (const uint32_t v : mesh.triangles[triangle]) {
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], mesh.vertices[v][a]);
        high[a] = std::max(high[a], mesh.vertices[v][a]);
      }
    }
  }
  bool below(const ComponentLimits& limits) const {
    return area < limits.min_area || norm((high - low).cast<double>()) < limits.min_extent ||
           triangles < limits.min_triangles;
  }
};

}  // namespace

CleaningReport clean_mesh(TriangleMesh& mesh, const ComponentLimits& limits) {
  CleaningReport report;
  std::vector<uint8_t> keep(mesh.triangles.size(), 1);
  DisjointSets components(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    for (const uint32_t v : c) {
      if (v >= mesh.vertices.size())
        throw_bad_input({}, "triangles", "a triangle refers to a vertex that does not exist");
    }
    // Sharing a vertex keeps parts together even where the triangle between them is degenerate.
    components.unite(c[0], c[1]);
    components.unite(c[1], c[2]);
    if (triangle_area(mesh, t) > 0) continue;
    keep[t] = 0;
    ++report.degenerate_triangles;
  }
  std::vector<Size> sizes(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t]) sizes[components.find(mesh.triangles[t][0])].add(mesh, t);
  }
  for (const Size& size : sizes) {
    if (size.triangles == 0) continue;
    ++report.components;
    if (!size.below(limits)) continue;
    ++report.removed_components;
    report.removed_triangles += size.triangles;
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t] && sizes[components.find(mesh.triangles[t][0])].below(limits)) keep[t] = 0;
  }
  const size_t before = mesh.vertices.size();
  mesh = keep_triangles(mesh, keep);
  report.removed_vertices = before - mesh.vertices.size();
  return report;
}

}  // namespace aligngs
