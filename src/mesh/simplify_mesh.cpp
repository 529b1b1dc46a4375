#include "mesh/simplify_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

/// Vertices of a part at one place whose normals differ by less are one: 45 degrees.
constexpr float kSameNormal = 0.7f;

/// Vertices by place, those of one place by number. The bits of a place are ordered where its numbers are not.
std::vector<uint32_t> by_place(const std::vector<Vec3f>& vertices) {
  const auto bits = [&](uint32_t v) {
    const Vec3f& p = vertices[v];
    const auto of = [](float x) { return std::bit_cast<uint32_t>(x + 0.0f); };  // -0 is 0
    return std::array<uint32_t, 4>{of(p.x), of(p.y), of(p.z), v};
  };
  std::vector<uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return bits(a) < bits(b); });
  return order;
}

/// Lets triangles of a part share vertices. Loose tiles of a floor do not.
void share_vertices(TriangleMesh& part) {
  const std::vector<uint32_t> order = by_place(part.vertices);
  const auto at_one_place = [&](uint32_t a, uint32_t b) {
    const Vec3f &p = part.vertices[a], &q = part.vertices[b];
    return p.x == q.x && p.y == q.y && p.z == q.z;
  };
  std::vector<uint32_t> same(part.vertices.size());
  std::vector<uint32_t> others;  // different vertices of the place
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t v = order[i];
    if (i == 0 || !at_one_place(order[i - 1], v)) others.clear();
    const auto found = std::find_if(others.begin(), others.end(), [&](uint32_t o) {
      return part.normals.empty() || dot(part.normals[o], part.normals[v]) > kSameNormal;
    });
    same[v] = found == others.end() ? v : *found;
    if (found == others.end()) others.push_back(v);
  }
  for (auto& t : part.triangles) t = {same[t[0]], same[t[1]], same[t[2]]};
  std::erase_if(part.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  // meshoptimizer looks at unused ones, too
  part = keep_triangles(part, std::vector<uint8_t>(part.triangles.size(), 1));
}

/// All parts as one index buffer.
struct Joined {
  std::vector<Vec3f> vertices;
  std::vector<unsigned int> indices;
  std::vector<size_t> first;  ///< vertex of each part, and their number at the end
};

Joined join(const std::vector<TriangleMesh*>& parts) {
  Joined all;
  size_t vertices = 0, triangles = 0;
  for (const TriangleMesh* part : parts) vertices += part->vertices.size(), triangles += part->triangles.size();
  all.vertices.reserve(vertices);
  all.indices.reserve(3 * triangles);
  for (const TriangleMesh* part : parts) {
    const uint32_t base = static_cast<uint32_t>(all.vertices.size());
    all.first.push_back(base);
    all.vertices.insert(all.vertices.end(), part->vertices.begin(), part->vertices.end());
    for (const auto& t : part->triangles) {
      for (const uint32_t v : t) all.indices.push_back(base + v);
    }
  }
  all.first.push_back(all.vertices.size());
  return all;
}

}  // namespace

SimplifyReport simplify_parts(const std::vector<TriangleMesh*>& parts, const SimplifyLimits& limits) {
  if (limits.triangles == 0 && !(limits.error > 0))
    throw_usage("a mesh is simplified to a number of triangles or to an error", "give one of them");
  SimplifyReport report;
  for (TriangleMesh* part : parts) {
    report.before += part->triangles.size();
    share_vertices(*part);
  }
  const Joined all = join(parts);
  report.after = all.indices.size() / 3;
  if (report.after <= limits.triangles || report.after == 0) return report;
  // meshoptimizer's errors are shares of the largest side of the box.
  const float* places = &all.vertices[0].x;
  const double size = meshopt_simplifyScale(places, all.vertices.size(), sizeof(Vec3f));
  if (!(size > 0)) return report;
  const float error = limits.error > 0 ? static_cast<float>(std::min(limits.error / size, 1.0)) : 1.0f;
  std::vector<unsigned int> left(all.indices.size());
  float reached = 0;
  left.resize(meshopt_simplify(left.data(), all.indices.data(), all.indices.size(), places, all.vertices.size(),
                               sizeof(Vec3f), 3 * limits.triangles, error, 0, &reached));
  report.after = left.size() / 3;
  report.error = reached * size;
  for (TriangleMesh* part : parts) part->triangles.clear();
  for (size_t i = 0; i < left.size(); i += 3) {
    // A triangle has vertices of one part alone: collapses never leave it.
    const size_t owner =
        static_cast<size_t>(std::upper_bound(all.first.begin(), all.first.end(), left[i]) - all.first.begin()) - 1;
    const auto local = [&](unsigned int v) { return static_cast<uint32_t>(v - all.first[owner]); };
    parts[owner]->triangles.push_back({local(left[i]), local(left[i + 1]), local(left[i + 2])});
  }
  for (TriangleMesh* part : parts) *part = keep_triangles(*part, std::vector<uint8_t>(part->triangles.size(), 1));
  return report;
}

}  // namespace aligngs
