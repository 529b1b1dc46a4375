#include "gaussians/density_links.h"

#include <algorithm>

#include "core/disjoint_sets.h"
#include "core/median.h"
#include "gaussians/soft_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint16_t kMostInstances = 65535;  // ushort in the file
constexpr size_t kInstanceGrain = 512;      // Gaussians per chunk

}  // namespace

DensityLinks density_links(const std::vector<Vec3f>& points, double extent, const InstanceOptions& options,
                           ThreadPool& pool) {
  DensityLinks out;
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
  std::vector<std::vector<uint32_t>>& near = out.near;
  std::vector<uint8_t>& core = out.core;
  near.resize(n);
  core.assign(n, 0);
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
  std::vector<uint32_t>& group = out.group;
  group.assign(n, DensityLinks::kNoise);
  out.reach = link;
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
  return out;
}

std::map<uint16_t, std::vector<uint32_t>> rows_by_class(const GaussianModel& model, const GaussianLabels& labels,
                                                        const InstanceOptions& options) {
  std::map<uint16_t, std::vector<uint32_t>> rows;
  for (uint32_t i = 0; i < model.size(); ++i) {
    if (labels.label[i] != kNoLabel && opacity_of(model, i) >= options.min_opacity) rows[labels.label[i]].push_back(i);
  }
  return rows;
}

void number_groups(const std::vector<uint32_t>& rows, const std::vector<uint32_t>& group,
                   const InstanceOptions& options, GaussianLabels& labels) {
  std::map<uint32_t, size_t> sizes;  // by smallest member: in row order
  for (const uint32_t g : group) {
    if (g != DensityLinks::kNoise) ++sizes[g];
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

}  // namespace aligngs
