#include "mesh/hole_filling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "mesh/fusion_frame.h"

namespace aligngs {
namespace {

constexpr uint32_t kNoRow = 0xffffffffu;

uint64_t key_of(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }

/// For each vertex the next one along the border, against the direction of the border's triangles, so that fillings are
/// oriented as the mesh is. Vertices where borders meet are left out.
std::vector<uint32_t> border_steps(const TriangleMesh& mesh) {
  std::unordered_set<uint64_t> directed;
  directed.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) directed.insert(key_of(t[i], t[(i + 1) % 3]));
  }
  std::vector<uint32_t> next(mesh.vertices.size(), kNoRow);
  std::vector<uint8_t> out(mesh.vertices.size(), 0), in(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = t[i], b = t[(i + 1) % 3];
      if (directed.count(key_of(b, a))) continue;
      next[b] = a;
      out[b] = static_cast<uint8_t>(std::min(2, out[b] + 1));
      in[a] = static_cast<uint8_t>(std::min(2, in[a] + 1));
    }
  }
  for (size_t v = 0; v < next.size(); ++v) {
    if (out[v] != 1 || in[v] != 1) next[v] = kNoRow;
  }
  return next;
}

struct Border {
  std::vector<uint32_t> vertices;
  Vec3d middle, normal;  ///< mean of the vertices; unit normal of the filling
  double size = 0;
};

Vec3d position(const TriangleMesh& mesh, uint32_t v) { return mesh.vertices[v].cast<double>(); }

/// Newell's normal and the box's diagonal.
void measure(const TriangleMesh& mesh, Border& border) {
  const double inf = std::numeric_limits<double>::infinity();
  Vec3d low{inf, inf, inf}, high = -low, sum;
  for (const uint32_t v : border.vertices) {
    const Vec3d p = position(mesh, v);
    sum += p;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  border.middle = sum * (1.0 / static_cast<double>(border.vertices.size()));
  border.size = norm(high - low);
  Vec3d area;
  for (size_t i = 0; i < border.vertices.size(); ++i) {
    const Vec3d a = position(mesh, border.vertices[i]) - border.middle;
    const Vec3d b = position(mesh, border.vertices[(i + 1) % border.vertices.size()]) - border.middle;
    area += cross(a, b);
  }
  border.normal = normalized(area);
}

bool star_shaped_and_flat(const TriangleMesh& mesh, const Border& border, const HoleFillingOptions& options) {
  if (!(norm(border.normal) > 0)) return false;
  for (size_t i = 0; i < border.vertices.size(); ++i) {
    const Vec3d a = position(mesh, border.vertices[i]) - border.middle;
    const Vec3d b = position(mesh, border.vertices[(i + 1) % border.vertices.size()]) - border.middle;
    if (std::abs(dot(a, border.normal)) > options.max_depth * border.size) return false;
    if (!(dot(cross(a, b), border.normal) > 0)) return false;
  }
  return true;
}

/// +1 where a view has its surface at the point, -1 where it looks through, 0 where it says nothing.
int judge(const HoleWitness& witness, const Vec3d& point, double tolerance) {
  const Vec3d p = witness.camera->world_to_camera * point;
  if (!(p.z > 0)) return 0;
  const Vec2d uv = witness.camera->project(p);
  if (!witness.camera->contains(uv)) return 0;
  const float d = valid_depth(*witness.depth, static_cast<int>(uv.x), static_cast<int>(uv.y));
  if (d == 0 || d < p.z - tolerance) return 0;
  return d <= p.z + tolerance ? 1 : -1;
}

bool seen_as_surface(const TriangleMesh& mesh, const Border& border, const std::vector<HoleWitness>& witnesses,
                     double tolerance) {
  int seen = 0, through = 0;
  const auto ask = [&](const Vec3d& point) {
    for (const HoleWitness& w : witnesses) {
      const int verdict = judge(w, point, tolerance);
      seen += verdict > 0;
      through += verdict < 0;
    }
  };
  ask(border.middle);
  const size_t step = std::max<size_t>(1, border.vertices.size() / 4);
  for (size_t i = 0; i < border.vertices.size(); i += step)
    ask((border.middle + position(mesh, border.vertices[i])) * 0.5);
  return seen > through;
}

void add_filling(TriangleMesh& mesh, const Border& border) {
  const auto centre = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(border.middle.cast<float>());
  if (!mesh.normals.empty()) mesh.normals.push_back(border.normal.cast<float>());
  if (!mesh.colors.empty()) {
    std::array<double, 3> sum{};
    for (const uint32_t v : border.vertices) {
      for (size_t c = 0; c < 3; ++c) sum[c] += mesh.colors[v][c];
    }
    std::array<uint8_t, 3> mean{};
    for (size_t c = 0; c < 3; ++c)
      mean[c] = static_cast<uint8_t>(std::lround(sum[c] / static_cast<double>(border.vertices.size())));
    mesh.colors.push_back(mean);
  }
  if (!mesh.labels.empty()) mesh.labels.push_back(kNoLabel);
  for (size_t i = 0; i < border.vertices.size(); ++i) {
    mesh.triangles.push_back({centre, border.vertices[i], border.vertices[(i + 1) % border.vertices.size()]});
  }
}

}  // namespace

HoleFillingReport close_seen_borders(TriangleMesh& mesh, const std::vector<HoleWitness>& witnesses,
                                     const HoleFillingOptions& options) {
  HoleFillingReport report;
  if (!(options.max_size > 0)) return report;
  std::vector<uint32_t> next = border_steps(mesh);
  const size_t vertices = next.size(), triangles = mesh.triangles.size();
  for (size_t start = 0; start < vertices; ++start) {
    Border border;
    uint32_t at = static_cast<uint32_t>(start);
    while (next[at] != kNoRow) {
      border.vertices.push_back(at);
      const uint32_t following = next[at];
      next[at] = kNoRow;  // each border is walked once
      at = following;
    }
    if (border.vertices.size() < 3 || at != start) continue;  // open: it runs into a vertex where borders meet
    ++report.borders;
    if (border.vertices.size() > options.max_edges) continue;
    measure(mesh, border);
    if (border.size > options.max_size || !star_shaped_and_flat(mesh, border, options)) continue;
    if (!seen_as_surface(mesh, border, witnesses, options.tolerance)) continue;
    add_filling(mesh, border);
    ++report.filled;
  }
  report.triangles = mesh.triangles.size() - triangles;
  return report;
}

}  // namespace aligngs
