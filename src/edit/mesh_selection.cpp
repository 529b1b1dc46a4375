#include "edit/mesh_selection.h"

#include <algorithm>
#include <cmath>

#include "gaussians/point_tree.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

/// A Gaussian as a quadratic form with floored scales.
struct Ellipsoid {
  Vec3f centre;
  Mat3f rotation;  ///< columns are the axes
  Vec3f inverse;   ///< 1 / standard deviation per axis
  float reach = 0;
  float opacity = 0;

  Ellipsoid(const GaussianModel& model, size_t i, float floor, float sigmas) {
    const float* p = &model.positions[3 * i];
    const float* q = &model.rotations[4 * i];
    centre = {p[0], p[1], p[2]};
    rotation = rotation_matrix(normalized(Quaternionf{q[0], q[1], q[2], q[3]}));
    for (int a = 0; a < 3; ++a) {
      const float sigma = std::max(std::exp(model.log_scales[3 * i + static_cast<size_t>(a)]), floor);
      inverse[a] = 1 / sigma;
      reach = std::max(reach, sigmas * sigma);
    }
    opacity = opacity_of(model, i);
  }
  float vote(const Vec3f& x) const {
    const Vec3f local = transpose_times(rotation, x - centre);
    const float a = local.x * inverse.x, b = local.y * inverse.y, c = local.z * inverse.z;
    return opacity * std::exp(-0.5f * (a * a + b * b + c * c));
  }
};

struct Box {
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  void add(const Vec3f& p, float r) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a] - r);
      high[a] = std::max(high[a], p[a] + r);
    }
  }
  bool touches(const Vec3f& p, float r) const {
    for (int a = 0; a < 3; ++a) {
      if (p[a] + r < low[a] || p[a] - r > high[a]) return false;
    }
    return true;
  }
};

/// Majority over the vertices that share a triangle, the vertex itself counting as two.
void smooth_flags(const TriangleMesh& mesh, int rounds, std::vector<uint8_t>& flags) {
  std::vector<int> vote(flags.size());
  for (int round = 0; round < rounds; ++round) {
    for (size_t i = 0; i < flags.size(); ++i) vote[i] = flags[i] ? 2 : -2;
    for (const auto& t : mesh.triangles) {
      for (int a = 0; a < 3; ++a) {
        vote[t[a]] += (flags[t[(a + 1) % 3]] ? 1 : -1) + (flags[t[(a + 2) % 3]] ? 1 : -1);
      }
    }
    for (size_t i = 0; i < flags.size(); ++i) {
      if (vote[i] != 0) flags[i] = vote[i] > 0;
    }
  }
}

}  // namespace

std::vector<uint8_t> select_vertices(const TriangleMesh& mesh, const GaussianModel& model,
                                     const std::vector<uint8_t>& selected, double extent,
                                     const MeshSelectionOptions& options) {
  const float floor = static_cast<float>(options.thickness * extent), sigmas = static_cast<float>(options.sigmas);
  std::vector<uint8_t> flags(mesh.vertices.size(), 0);
  std::vector<Ellipsoid> chosen;
  Box box;
  for (size_t i = 0; i < model.size(); ++i) {
    if (!selected[i]) continue;
    chosen.emplace_back(model, i, floor, sigmas);
    box.add(chosen.back().centre, chosen.back().reach);
  }
  if (chosen.empty() || mesh.vertices.empty()) return flags;

  // Only vertices that a selected Gaussian reaches can be selected.
  std::vector<Vec3f> points;
  std::vector<uint32_t> vertex_of;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!box.touches(mesh.vertices[v], 0)) continue;
    points.push_back(mesh.vertices[v]);
    vertex_of.push_back(v);
  }
  const PointTree tree(std::move(points));
  std::vector<double> balance(tree.size(), 0.0);
  std::vector<PointTree::Neighbour> near;
  const auto scatter = [&](const Ellipsoid& e, double sign) {
    tree.within(e.centre, e.reach, near);
    for (const PointTree::Neighbour& n : near) balance[n.index] += sign * e.vote(tree.point(n.index));
  };
  for (const Ellipsoid& e : chosen) scatter(e, 1);
  for (size_t i = 0; i < model.size(); ++i) {
    if (selected[i]) continue;
    const Ellipsoid e(model, i, floor, sigmas);
    if (box.touches(e.centre, e.reach)) scatter(e, -1);
  }
  for (size_t i = 0; i < tree.size(); ++i) flags[vertex_of[i]] = balance[i] > 0;
  smooth_flags(mesh, options.smoothing_rounds, flags);
  return flags;
}

TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<uint8_t>& flags, uint8_t value) {
  constexpr uint32_t kUnused = 0xffffffffu;
  TriangleMesh out;
  std::vector<uint32_t> moved(mesh.vertices.size(), kUnused);
  const auto move = [&](uint32_t v) {
    if (moved[v] == kUnused) {
      moved[v] = static_cast<uint32_t>(out.vertices.size());
      out.vertices.push_back(mesh.vertices[v]);
      if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
      if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
      if (!mesh.labels.empty()) out.labels.push_back(mesh.labels[v]);
    }
    return moved[v];
  };
  for (const auto& t : mesh.triangles) {
    if ((flags[t[0]] == value) + (flags[t[1]] == value) + (flags[t[2]] == value) < 2) continue;
    const uint32_t a = move(t[0]), b = move(t[1]), c = move(t[2]);
    out.triangles.push_back({a, b, c});
  }
  return out;
}

}  // namespace aligngs
