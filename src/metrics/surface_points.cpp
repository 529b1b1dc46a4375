#include "metrics/surface_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/error.h"
#include "core/random.h"

namespace aligngs {
namespace {

constexpr double kMaxVoxelsPerAxis = 1 << 21;  // three coordinates share one 64-bit key

bool finite(const Vec3f& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

Vec3d doubled_area_normal(const TriangleMesh& mesh, size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d a = mesh.vertices[t[0]].cast<double>();
  return cross(mesh.vertices[t[1]].cast<double>() - a, mesh.vertices[t[2]].cast<double>() - a);
}

/// Numbers the voxels of points in order of first appearance.
class VoxelGrid {
 public:
  VoxelGrid(const std::vector<Vec3f>& points, double voxel) : voxel_(voxel) {
    if (!(voxel > 0)) throw_usage(fmt::format("a voxel of {} cannot thin points", voxel), "give a positive size");
    const double inf = std::numeric_limits<double>::infinity();
    Vec3d low{inf, inf, inf}, high{-inf, -inf, -inf};
    for (const Vec3f& p : points) {
      if (!finite(p)) continue;
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], double(p[a]));
        high[a] = std::max(high[a], double(p[a]));
      }
    }
    for (int a = 0; a < 3; ++a) {
      if (high[a] - low[a] > (kMaxVoxelsPerAxis - 2) * voxel) {
        throw_usage(fmt::format("points span {:.3g} units, too many voxels of {}", high[a] - low[a], voxel),
                    "use a larger voxel, or look for stray points");
      }
    }
    origin_ = low - Vec3d{voxel / 2, voxel / 2, voxel / 2};
    voxels_.reserve(points.size() / 2 + 1);
  }

  size_t number(const Vec3f& point) {
    uint64_t key = 0;
    for (int a = 0; a < 3; ++a) {
      key = key << 21 | static_cast<uint64_t>(std::floor((double(point[a]) - origin_[a]) / voxel_));
    }
    return voxels_.emplace(key, voxels_.size()).first->second;
  }

 private:
  double voxel_;
  Vec3d origin_;
  std::unordered_map<uint64_t, size_t> voxels_;
};

/// Running mean of points.
struct Mean {
  Vec3d sum;
  double count = 0;
  void add(const Vec3f& p) {
    sum += p.cast<double>();
    ++count;
  }
  Vec3f value() const { return (sum * (1 / count)).cast<float>(); }
};

}  // namespace

double triangle_area(const TriangleMesh& mesh, size_t triangle) {
  const double area = 0.5 * norm(doubled_area_normal(mesh, triangle));
  return std::isfinite(area) ? area : 0;
}

SurfaceSamples sample_surface(const TriangleMesh& mesh, const SamplingOptions& options) {
  SurfaceSamples samples;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) samples.area += triangle_area(mesh, t);
  if (!(samples.area > 0)) return samples;
  const double wanted = std::ceil(samples.area * options.points_per_area);
  samples.capped = wanted > static_cast<double>(options.max_points);
  const size_t count = samples.capped ? options.max_points : static_cast<size_t>(wanted);
  samples.positions.reserve(count);
  samples.normals.reserve(count);
  samples.triangles.reserve(count);

  Random random(options.seed);
  const double step = samples.area / static_cast<double>(count);
  double passed = 0;  // area of the triangles before this one
  size_t next = 0;    // sample: lies at (next + u) * step on the running sum of areas
  double position = random.uniform() * step;
  for (size_t t = 0; t < mesh.triangles.size() && next < count; ++t) {
    const double area = triangle_area(mesh, t);
    if (area == 0) continue;
    passed += area;
    const auto& corner = mesh.triangles[t];
    const Vec3d a = mesh.vertices[corner[0]].cast<double>(), b = mesh.vertices[corner[1]].cast<double>();
    const Vec3d c = mesh.vertices[corner[2]].cast<double>();
    const Vec3f normal = normalized(doubled_area_normal(mesh, t)).cast<float>();
    while (next < count && position < passed) {
      // Uniform in a triangle (Osada et al. 2002): the square root undoes the narrowing towards a corner.
      const double s = std::sqrt(random.uniform()), u = random.uniform();
      samples.positions.push_back((a * (1 - s) + b * (s * (1 - u)) + c * (s * u)).cast<float>());
      samples.normals.push_back(normal);
      samples.triangles.push_back(static_cast<uint32_t>(t));
      ++next;
      position = (static_cast<double>(next) + random.uniform()) * step;
    }
  }
  return samples;
}

std::vector<Vec3f> thin_to_voxels(const std::vector<Vec3f>& points, double voxel) {
  VoxelGrid grid(points, voxel);
  std::vector<Mean> means;
  for (const Vec3f& p : points) {
    if (!finite(p)) continue;
    const size_t v = grid.number(p);
    if (v == means.size()) means.emplace_back();
    means[v].add(p);
  }
  std::vector<Vec3f> thinned;
  thinned.reserve(means.size());
  for (const Mean& m : means) thinned.push_back(m.value());
  return thinned;
}

LabelledPoints thin_labelled(const std::vector<Vec3f>& points, const std::vector<uint16_t>& labels, double voxel) {
  std::vector<std::pair<size_t, uint16_t>> votes;  // voxel, label
  VoxelGrid grid(points, voxel);
  std::vector<Mean> means;
  for (size_t i = 0; i < points.size(); ++i) {
    if (labels[i] == kNoLabel || !finite(points[i])) continue;
    const size_t v = grid.number(points[i]);
    if (v == means.size()) means.emplace_back();
    means[v].add(points[i]);
    votes.emplace_back(v, labels[i]);
  }
  std::sort(votes.begin(), votes.end());
  LabelledPoints thinned;
  thinned.positions.reserve(means.size());
  for (const Mean& m : means) thinned.positions.push_back(m.value());
  thinned.labels.assign(means.size(), kNoLabel);
  for (size_t begin = 0, best = 0; begin < votes.size();) {
    size_t end = begin;
    while (end < votes.size() && votes[end] == votes[begin]) ++end;
    const auto [v, label] = votes[begin];
    if (begin == 0 || votes[begin - 1].first != v) best = 0;
    if (end - begin > best) {
      best = end - begin;
      thinned.labels[v] = label;
    }
    begin = end;
  }
  return thinned;
}

}  // namespace aligngs
