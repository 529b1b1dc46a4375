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

/// Ellipsoid::reach without the rotation, which takes longest.
float largest_reach(const GaussianModel& model, size_t i, float floor, float sigmas) {
  const float* s = &model.log_scales[3 * i];
  return sigmas * std::max(std::exp(std::max({s[0], s[1], s[2]})), floor);
}

/// Adds the votes of Gaussians to the points of a tree. Blocks are looked up in parallel and added one after the other,
/// so that the sums are the same for any number of threads.
void add_votes(const std::vector<Ellipsoid>& gaussians, const PointTree& tree, double sign, ThreadPool& pool,
               std::vector<double>& balance) {
  constexpr size_t kGrain = 256, kRound = 64;  // Gaussians of a block, blocks at a time
  struct Vote {
    uint32_t point;
    float vote;
  };
  for (size_t first = 0; first < gaussians.size(); first += kGrain * kRound) {
    const size_t count = std::min(gaussians.size() - first, kGrain * kRound);
    std::vector<std::vector<Vote>> votes((count + kGrain - 1) / kGrain);
    pool.parallel_for(count, kGrain, [&](size_t begin, size_t end, int) {
      std::vector<uint32_t> near;
      std::vector<Vote>& block = votes[begin / kGrain];
      for (size_t i = begin; i < end; ++i) {
        const Ellipsoid& e = gaussians[first + i];
        tree.within_unordered(e.centre, e.reach, near);
        for (const uint32_t n : near) block.push_back({n, e.vote(tree.point(n))});
      }
    });
    for (const std::vector<Vote>& block : votes) {
      for (const Vote& v : block) balance[v.point] += sign * v.vote;
    }
  }
}

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
                                     const std::vector<uint8_t>& selected, double extent, ThreadPool& pool,
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
  add_votes(chosen, tree, 1, pool, balance);

  // Votes of the others matter only where there are votes against them.
  Box claimed;
  points.clear();
  size_t kept = 0;
  for (size_t i = 0; i < tree.size(); ++i) {
    if (!(balance[i] > 0)) continue;
    points.push_back(tree.point(i));
    claimed.add(points.back(), 0);
    vertex_of[kept] = vertex_of[i];
    balance[kept++] = balance[i];
  }
  balance.resize(kept);
  std::vector<Ellipsoid> others;
  for (size_t i = 0; i < model.size(); ++i) {
    if (selected[i]) continue;
    constexpr float kRounding = 1.001f;
    const Vec3f centre{model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
    const float reach = largest_reach(model, i, floor, sigmas);
    if (!claimed.touches(centre, kRounding * reach) || !box.touches(centre, reach)) continue;
    others.emplace_back(model, i, floor, sigmas);
  }
  add_votes(others, PointTree(std::move(points)), -1, pool, balance);
  for (size_t i = 0; i < kept; ++i) flags[vertex_of[i]] = balance[i] > 0;
  smooth_flags(mesh, options.smoothing_rounds, flags);
  return flags;
}

TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<uint8_t>& flags, uint8_t value, SubmeshRows* rows) {
  std::vector<uint32_t> triangles;
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if ((flags[t[0]] == value) + (flags[t[1]] == value) + (flags[t[2]] == value) >= 2) triangles.push_back(i);
  }
  return submesh(mesh, triangles, rows);
}

TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<uint32_t>& triangles, SubmeshRows* rows) {
  constexpr uint32_t kUnused = 0xffffffffu;
  std::vector<uint32_t> moved(mesh.vertices.size(), kUnused), vertices;
  for (const uint32_t i : triangles) {
    for (const uint32_t v : mesh.triangles[i]) moved[v] = 0;
  }
  for (uint32_t v = 0; v < moved.size(); ++v) {
    if (moved[v] == kUnused) continue;
    moved[v] = static_cast<uint32_t>(vertices.size());
    vertices.push_back(v);
  }
  TriangleMesh out;
  out.vertices.reserve(vertices.size());
  for (const uint32_t v : vertices) {
    out.vertices.push_back(mesh.vertices[v]);
    if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
    if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
    if (!mesh.labels.empty()) out.labels.push_back(mesh.labels[v]);
  }
  out.triangles.reserve(triangles.size());
  for (const uint32_t i : triangles) {
    const auto& t = mesh.triangles[i];
    out.triangles.push_back({moved[t[0]], moved[t[1]], moved[t[2]]});
  }
  if (rows) *rows = {std::move(vertices), triangles};
  return out;
}

}  // namespace aligngs
