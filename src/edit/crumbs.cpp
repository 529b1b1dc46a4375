#include "edit/crumbs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "scene/triangle_mesh.h"

namespace aligngs {

namespace {

constexpr double kUnlikeVote = 0.05;  ///< of a neighbour of another colour: it decides only where no other one votes

/// Weights of the votes of neighbours; the same in every round.
std::vector<float> vote_weights(const GaussianModel& model, const std::vector<uint32_t>& marked,
                                const NeighbourGraph& graph, double color_sigma) {
  std::vector<float> weights(graph.index.size());
  const double scale = color_sigma > 0 ? -0.5 / (color_sigma * color_sigma) : 0;
  for (size_t m = 0; m < marked.size(); ++m) {
    const Vec3f color = base_color_of(model, marked[m]);
    for (size_t slot = graph.k * m; slot < graph.k * (m + 1); ++slot) {
      const uint32_t j = graph.index[slot];
      weights[slot] = opacity_of(model, j);
      if (scale == 0) continue;
      const Vec3f unlike = base_color_of(model, j) - color;
      weights[slot] *= static_cast<float>(kUnlikeVote + std::exp(scale * dot(unlike, unlike)));
    }
  }
  return weights;
}

}  // namespace

const PointTree& RoomTree::tree() {
  if (!tree_) tree_.emplace(positions_of(model_));
  return *tree_;
}

size_t join_neighbours(LabelledGaussians& room, const std::vector<uint8_t>& rows, const CrumbOptions& options,
                       ThreadPool& pool, const MayJoin& may_join, RoomTree* tree) {
  const size_t k = static_cast<size_t>(options.neighbours);
  std::vector<uint32_t> marked;
  for (uint32_t i = 0; i < rows.size(); ++i) {
    if (rows[i]) marked.push_back(i);
  }
  if (room.model.size() <= k || marked.empty()) return 0;
  RoomTree own(room.model);
  const NeighbourGraph graph = neighbour_graph((tree ? *tree : own).tree(), marked, k, pool);
  const std::vector<float> weights = vote_weights(room.model, marked, graph, options.color_sigma);
  std::vector<uint8_t> open = rows;
  size_t joined = 0;
  // From the outside of a group inwards: the inner ones have neighbours with an object only when the outer ones have.
  int round = 0;
  for (bool moved = true; moved && (options.rounds == 0 || round < options.rounds); ++round) {
    moved = false;
    const std::vector<uint8_t> before = open;
    for (size_t m = 0; m < marked.size(); ++m) {
      const uint32_t i = marked[m];
      if (!before[i]) continue;
      double all = 0;
      std::map<std::pair<uint16_t, uint16_t>, double> votes;
      for (size_t slot = k * m; slot < k * (m + 1); ++slot) {
        const uint32_t j = graph.index[slot];
        const uint16_t label = room.labels.label[j], instance = room.labels.instance[j];
        all += weights[slot];
        if (before[j] || label == kNoLabel || instance == 0 || (may_join && !may_join(i, label))) continue;
        votes[{label, instance}] += weights[slot] * (label == room.labels.label[i] ? options.own_class : 1);
      }
      if (votes.empty()) continue;
      const auto best = std::max_element(votes.begin(), votes.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      if (best->first.first != room.labels.label[i] && best->second < options.majority * all) continue;
      std::tie(room.labels.label[i], room.labels.instance[i]) = best->first;
      open[i] = 0;
      moved = true;
      ++joined;
    }
  }
  return joined;
}

std::vector<uint8_t> crumb_rows(const LabelledGaussians& room, const CrumbOptions& options) {
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
  return rows;
}

size_t join_crumbs(LabelledGaussians& room, const CrumbOptions& options, ThreadPool& pool, RoomTree* tree) {
  return room.has_labels() ? join_neighbours(room, crumb_rows(room, options), options, pool, {}, tree) : 0;
}

}  // namespace aligngs
