#include "mesh/neighbour_order.h"

#include <meshoptimizer.h>

#include <algorithm>

namespace aligngs {
namespace {

constexpr uint32_t kUnused = 0xffffffffu;

template <class T>
void take_first_uses(std::vector<T>& values, const std::vector<uint32_t>& first_uses) {
  if (values.empty()) return;
  std::vector<T> out;
  out.reserve(first_uses.size());
  for (const uint32_t v : first_uses) out.push_back(values[v]);
  values = std::move(out);
}

}  // namespace

void order_by_neighbours(TriangleMesh& mesh) {
  std::vector<unsigned int> indices, ordered;
  for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  ordered.resize(indices.size());
  if (!indices.empty())
    meshopt_optimizeVertexCache(ordered.data(), indices.data(), indices.size(), mesh.vertices.size());
  std::vector<uint32_t> place(mesh.vertices.size(), kUnused), first_uses;
  for (size_t i = 0; i < ordered.size(); ++i) {
    const unsigned int v = ordered[i];
    if (place[v] == kUnused) {
      place[v] = static_cast<uint32_t>(first_uses.size());
      first_uses.push_back(v);
    }
    mesh.triangles[i / 3][i % 3] = place[v];
  }
  take_first_uses(mesh.vertices, first_uses);
  take_first_uses(mesh.normals, first_uses);
  take_first_uses(mesh.colors, first_uses);
  take_first_uses(mesh.labels, first_uses);
}

}  // namespace aligngs
