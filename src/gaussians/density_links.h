// Density links between the Gaussians of one class, and the numbers of the groups that follow. src/gaussians internal:
// use gaussians/instances.h or gaussians/object_votes.h.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "gaussians/instances.h"
#include "gaussians/point_tree.h"

namespace aligngs {

/// DBSCAN over points of one class.
struct DensityLinks {
  static constexpr uint32_t kNoise = NeighbourGraph::kNone;
  float reach = 0;                          ///< link distance, scene units
  std::vector<uint8_t> core;                ///< has enough neighbours within the reach
  std::vector<std::vector<uint32_t>> near;  ///< neighbours within the reach, nearest first
  std::vector<uint32_t> group;              ///< smallest core member of its group; kNoise
};
DensityLinks density_links(const std::vector<Vec3f>& points, double extent, const InstanceOptions& options,
                           ThreadPool& pool);

/// Rows with that class that are opaque enough to connect anything, ascending.
std::map<uint16_t, std::vector<uint32_t>> rows_by_class(const GaussianModel& model, const GaussianLabels& labels,
                                                        const InstanceOptions& options);

/// Numbers the groups of a class in labels.instance, the largest first; crumbs and noise are left at 0. `group`: per
/// row, the same number for the same group.
void number_groups(const std::vector<uint32_t>& rows, const std::vector<uint32_t>& group,
                   const InstanceOptions& options, GaussianLabels& labels);

}  // namespace aligngs
