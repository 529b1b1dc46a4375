#include "mesh/mesh_cleaning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

/// Union-find over vertices; the root of a set is its smallest vertex.
class Components {
 public:
  explicit Components(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t root(uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(uint32_t a, uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

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
  Components components(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    for (const uint32_t v : c) {
      if (v >= mesh.vertices.size()) throw_bad_input({}, "triangles", "a triangle refers to a vertex that does not exist");
    }
    // Sharing a vertex keeps parts together even where the triangle between them is degenerate.
    components.join(c[0], c[1]);
    components.join(c[1], c[2]);
    if (triangle_area(mesh, t) > 0) continue;
    keep[t] = 0;
    ++report.degenerate_triangles;
  }
  std::vector<Size> sizes(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t]) sizes[components.root(mesh.triangles[t][0])].add(mesh, t);
  }
  for (const Size& size : sizes) {
    if (size.triangles == 0) continue;
    ++report.components;
    if (!size.below(limits)) continue;
    ++report.removed_components;
    report.removed_triangles += size.triangles;
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t] && sizes[components.root(mesh.triangles[t][0])].below(limits)) keep[t] = 0;
  }
  const size_t before = mesh.vertices.size();
  mesh = keep_triangles(mesh, keep);
  report.removed_vertices = before - mesh.vertices.size();
  return report;
}

}  // namespace aligngs
