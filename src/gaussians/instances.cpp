#include "gaussians/instances.h"

#include <algorithm>
#include <map>

#include "core/disjoint_sets.h"
#include "core/median.h"
#include "gaussians/point_tree.h"
#include "gaussians/soft_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint16_t kMostInstances = 65535;  // ushort in the file
constexpr size_t kInstanceGrain = 512;      // Gaussians per chunk

/// Group of each point (the smallest member's index), or kNone for noise.
std::vector<uint32_t> cluster(const std::vector<Vec3f>& points, double extent, const InstanceOptions& options,
                              ThreadPool& pool) {
  constexpr uint32_t kNone = NeighbourGraph::kNone;
  const size_t n = points.size(), wanted = static_cast<size_t>(std::max(1, options.core_neighbours));
  constexpr size_t kFan =
      4;  // links per point / core_neighbours: bounds the work where points lie on top of each other
  const PointTree tree(points);
  std::vector<float> spacing(n);
  pool.parallel_for(n, kInstanceGrain, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> found;
    for (size_t i = begin; i < end; ++i) {
      tree.nearest(points[i], wanted + 1, found);
      spacing[i] = found.back().distance;
    }
  });
  // The limits keep apart what a coarse class would join, but never fall below the spacing itself.
  constexpr double kLeastSpacings = 1.2;
  const double typical = median_of(spacing);
  const double most = std::max(options.link_max * extent, kLeastSpacings * typical);
  const float link =
      static_cast<float>(std::clamp(options.link_spacings * typical, std::min(options.link_min * extent, most), most));

  // Neighbour lists of core points only: a border point hangs on its nearest core point.
  std::vector<std::vector<uint32_t>> near(n);
  std::vector<uint8_t> core(n, 0);
  pool.parallel_for(n, kInstanceGrain, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> found;
    for (size_t i = begin; i < end; ++i) {
      core[i] = n > wanted && spacing[i] < link;
      tree.nearest(points[i], kFan * wanted, found);
      for (const PointTree::Neighbour& neighbour : found) {
        if (neighbour.distance < link) near[i].push_back(neighbour.index);
      }
    }
  });
  DisjointSets sets(n);
  for (uint32_t i = 0; i < n; ++i) {
    if (!core[i]) continue;
    for (const uint32_t j : near[i]) {
      if (core[j]) sets.unite(i, j);
    }
  }
  std::vector<uint32_t> group(n, kNone);
  for (uint32_t i = 0; i < n; ++i) {
    if (core[i]) group[i] = sets.find(i);
  }
  for (uint32_t i = 0; i < n; ++i) {
    if (core[i]) continue;
    for (const uint32_t j : near[i]) {  // nearest first
      if (!core[j]) continue;
      group[i] = sets.find(j);
      break;
    }
  }
  return group;
}

void number_class(const std::vector<uint32_t>& rows, const std::vector<uint32_t>& group, const InstanceOptions& options,
                  GaussianLabels& labels) {
  std::map<uint32_t, size_t> sizes;  // by smallest member: in row order
  for (const uint32_t g : group) {
    if (g != NeighbourGraph::kNone) ++sizes[g];
  }
  std::vector<std::pair<uint32_t, size_t>> order(sizes.begin(), sizes.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::map<uint32_t, uint16_t> numbers;
  for (const auto& [g, size] : order) {
    if (size < options.min_gaussians ||
        static_cast<double>(size) < options.min_share * static_cast<double>(order[0].second))
      break;
    if (numbers.size() == kMostInstances) break;
    numbers.emplace(g, static_cast<uint16_t>(numbers.size() + 1));
  }
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto it = numbers.find(group[i]);
    if (it != numbers.end()) labels.instance[rows[i]] = it->second;
  }
}

}  // namespace

std::vector<Instance> find_instances(const GaussianModel& model, GaussianLabels& labels, double extent,
                                     const InstanceOptions& options, ThreadPool& pool) {
  const std::vector<Vec3f> positions = positions_of(model);
  std::map<uint16_t, std::vector<uint32_t>> rows;
  for (uint32_t i = 0; i < positions.size(); ++i) {
    if (labels.label[i] != kNoLabel && opacity_of(model, i) >= options.min_opacity) rows[labels.label[i]].push_back(i);
  }
  labels.instance.assign(positions.size(), 0);
  for (const auto& [label, members] : rows) {
    std::vector<Vec3f> points;
    for (const uint32_t i : members) points.push_back(positions[i]);
    number_class(members, cluster(points, extent, options, pool), options, labels);
  }
  return list_instances(model, labels);
}

std::vector<Instance> list_instances(const GaussianModel& model, const GaussianLabels& labels) {
  std::map<std::pair<int, int>, Instance> table;
  std::map<std::pair<int, int>, Vec3d> sums;
  for (size_t i = 0; i < model.size(); ++i) {
    if (labels.instance[i] == 0 || labels.label[i] == kNoLabel) continue;
    const Vec3f p{model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
    const std::pair<int, int> key(labels.label[i], labels.instance[i]);
    Instance& entry = table[key];
    if (entry.gaussians++ == 0) {
      entry.label = key.first;
      entry.number = key.second;
      entry.low = entry.high = p;
    }
    for (int a = 0; a < 3; ++a) {
      entry.low[a] = std::min(entry.low[a], p[a]);
      entry.high[a] = std::max(entry.high[a], p[a]);
    }
    sums[key] += p.cast<double>();
  }
  std::vector<Instance> out;
  for (auto& [key, entry] : table) {
    entry.centre = (sums[key] * (1.0 / static_cast<double>(entry.gaussians))).cast<float>();
    out.push_back(entry);
  }
  return out;
}

}  // namespace aligngs
