#include "scene/voxel_merge.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace aligngs {
namespace {

struct Cell {
  int32_t x, y, z;
  uint32_t point;
};

int32_t cell_coordinate(double value, double edge) {
  // Outliers of a bad reconstruction may lie 1e9 cells away: they share the outermost cells.
  return static_cast<int32_t>(std::clamp(std::floor(value / edge), -2147483647.0, 2147483647.0));
}

bool finite(const Vec3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Sums in double: a cube may hold thousands of points.
struct Sum {
  Vec3d position, color, normal;
  double weight = 0;
};

void append(const Sum& sum, bool with_normals, VoxelMerge& out) {
  const double s = 1 / sum.weight;
  out.cloud.positions.push_back((sum.position * s).cast<float>());
  out.cloud.colors.push_back((sum.color * s).cast<float>());
  if (with_normals) out.cloud.normals.push_back(normalized(sum.normal).cast<float>());
  out.weights.push_back(static_cast<float>(sum.weight));
}

}  // namespace

VoxelMerge voxel_merge(const PointCloud& cloud, double edge, const std::vector<float>& weights) {
  VoxelMerge out;
  const bool with_normals = cloud.has_normals(), merge = edge > 0;
  out.cell_of.assign(cloud.size(), VoxelMerge::kDropped);

  std::vector<Cell> cells;
  cells.reserve(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    if (!finite(p) || !finite(cloud.colors[i])) continue;
    if (!weights.empty() && !(weights[i] > 0 && std::isfinite(weights[i]))) continue;
    const uint32_t index = static_cast<uint32_t>(i);
    if (merge) {
      cells.push_back({cell_coordinate(p.x, edge), cell_coordinate(p.y, edge), cell_coordinate(p.z, edge), index});
    } else {
      cells.push_back({0, 0, 0, index});
    }
  }
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
    return std::tie(a.x, a.y, a.z, a.point) < std::tie(b.x, b.y, b.z, b.point);
  });

  // Runs of one cube, put in order of their first point.
  std::vector<std::pair<size_t, size_t>> runs;
  for (size_t begin = 0; begin < cells.size();) {
    size_t end = begin + 1;
    while (merge && end < cells.size() && cells[end].x == cells[begin].x && cells[end].y == cells[begin].y &&
           cells[end].z == cells[begin].z) {
      ++end;
    }
    runs.emplace_back(begin, end);
    begin = end;
  }
  std::sort(runs.begin(), runs.end(),
            [&](const auto& a, const auto& b) { return cells[a.first].point < cells[b.first].point; });

  out.cloud.positions.reserve(runs.size());
  out.cloud.colors.reserve(runs.size());
  for (const auto& [begin, end] : runs) {
    Sum sum;
    for (size_t k = begin; k < end; ++k) {
      const uint32_t i = cells[k].point;
      const double w = weights.empty() ? 1.0 : weights[i];
      sum.position += cloud.positions[i].cast<double>() * w;
      sum.color += cloud.colors[i].cast<double>() * w;
      if (with_normals && finite(cloud.normals[i])) sum.normal += cloud.normals[i].cast<double>() * w;
      sum.weight += w;
      out.cell_of[i] = static_cast<uint32_t>(out.cloud.size());
    }
    append(sum, with_normals, out);
  }
  return out;
}

}  // namespace aligngs
