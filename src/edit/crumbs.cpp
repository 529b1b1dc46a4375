#include "edit/crumbs.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "scene/triangle_mesh.h"

namespace aligngs {

size_t join_neighbours(LabelledGaussians& room, const std::vector<uint8_t>& rows, const CrumbOptions& options,
                       ThreadPool& pool) {
  const size_t k = static_cast<size_t>(options.neighbours);
  std::vector<uint32_t> marked;
  for (uint32_t i = 0; i < rows.size(); ++i) {
    if (rows[i]) marked.push_back(i);
  }
  if (room.model.size() <= k || marked.empty()) return 0;
  const NeighbourGraph graph = neighbour_graph(positions_of(room.model), marked, k, pool);
  std::vector<uint8_t> open = rows;
  size_t joined = 0;
  // From the outside of a group inwards: the inner ones have neighbours with an object only when the outer ones have.
  for (bool moved = true; moved;) {
    moved = false;
    const std::vector<uint8_t> before = open;
    for (size_t m = 0; m < marked.size(); ++m) {
      const uint32_t i = marked[m];
      if (!before[i]) continue;
      std::map<std::pair<uint16_t, uint16_t>, double> votes;
      for (size_t slot = k * m; slot < k * (m + 1); ++slot) {
        const uint32_t j = graph.index[slot];
        const uint16_t label = room.labels.label[j], instance = room.labels.instance[j];
        if (before[j] || label == kNoLabel || instance == 0) continue;
        votes[{label, instance}] += opacity_of(room.model, j) * (label == room.labels.label[i] ? options.own_class : 1);
      }
      if (votes.empty()) continue;
      const auto best = std::max_element(votes.begin(), votes.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      std::tie(room.labels.label[i], room.labels.instance[i]) = best->first;
      open[i] = 0;
      moved = true;
      ++joined;
    }
  }
  return joined;
}

size_t join_crumbs(LabelledGaussians& room, const CrumbOptions& options, ThreadPool& pool) {
  if (!room.has_labels()) return 0;
  std::set<std::pair<uint16_t, uint16_t>> crumbs;
  for (const Instance& object : list_instances(room.model, room.labels)) {
    const bool is_small = norm(object.high - object.low) < options.small * room.extent;
    if (object.gaussians < options.fewest || (object.gaussians < options.few && is_small))
      crumbs.insert({static_cast<uint16_t>(object.label), static_cast<uint16_t>(object.number)});
  }
  std::vector<uint8_t> rows(room.model.size(), 0);
  for (size_t i = 0; i < rows.size(); ++i) {
    const uint16_t label = room.labels.label[i];
    rows[i] =
        label != kNoLabel && (room.labels.instance[i] == 0 || crumbs.count({label, room.labels.instance[i]}) != 0);
  }
  return join_neighbours(room, rows, options, pool);
}

}  // namespace aligngs
