#include "gaussians/instances.h"

#include <algorithm>
#include <map>

#include "gaussians/density_links.h"
#include "gaussians/soft_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

std::vector<Instance> find_instances(const GaussianModel& model, GaussianLabels& labels, double extent,
                                     const InstanceOptions& options, ThreadPool& pool) {
  const std::vector<Vec3f> positions = positions_of(model);
  labels.instance.assign(positions.size(), 0);
  for (const auto& [label, members] : rows_by_class(model, labels, options)) {
    std::vector<Vec3f> points;
    for (const uint32_t i : members) points.push_back(positions[i]);
    number_groups(members, density_links(points, extent, options, pool).group, options, labels);
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
