#include "edit/touching_objects.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "core/median.h"
#include "edit/object_rows.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/point_tree.h"

namespace aligngs {
namespace {

/// Compact things that lie together.
constexpr const char* kInHeaps[] = {"pillow", "cushion", "book", "box", "bottle", "vase"};
constexpr int kMostInstances = 65535;  // ushort in the file

/// A link between two Gaussians of an object.
struct Link {
  uint32_t a = 0, b = 0;
  double weight = 0;
};

/// A plane between two parts: dot(normal, x) < offset on one side.
struct Waist {
  double ratio = std::numeric_limits<double>::infinity();  ///< see TouchingObjectSettings::waist
  Vec3d normal;
  double offset = 0;
};

/// Directions on half a sphere, evenly (a Fibonacci lattice); the upright one first.
std::vector<Vec3d> directions_of(const std::optional<Vec3d>& up, int count) {
  const double golden = M_PI * (1 + std::sqrt(5.0));
  std::vector<Vec3d> out;
  if (up) out.push_back(*up);
  for (int k = 0; k < count; ++k) {
    const double y = 1 - (k + 0.5) / count, radius = std::sqrt(1 - y * y), angle = golden * (k + 0.5);
    out.push_back({radius * std::cos(angle), y, radius * std::sin(angle)});
  }
  return out;
}

class WaistSearch {
 public:
  WaistSearch(std::vector<Vec3f> points, const TouchingObjectSettings& settings, ThreadPool& pool)
      : points_(std::move(points)), settings_(settings), pool_(pool) {
    const size_t k = static_cast<size_t>(std::max(settings.neighbours, settings.spacing_neighbour));
    const NeighbourGraph graph = neighbour_graph(points_, k, pool);
    std::vector<float> spacings;
    for (size_t i = 0; i < points_.size(); ++i)
      spacings.push_back(graph.distance[k * i + static_cast<size_t>(settings.spacing_neighbour) - 1]);
    const double spacing = median_of(std::move(spacings));
    if (!(spacing > 0) || !std::isfinite(spacing)) return;
    for (uint32_t i = 0; i < points_.size(); ++i) {
      for (size_t slot = k * i; slot < k * i + static_cast<size_t>(settings.neighbours); ++slot) {
        if (graph.index[slot] == NeighbourGraph::kNone) continue;
        const double far = graph.distance[slot] / spacing;
        links_.push_back({i, graph.index[slot], std::exp(-0.5 * far * far)});
      }
    }
  }

  /// The narrowest one of all directions; the first of equal ones.
  Waist narrowest(const std::vector<Vec3d>& directions) const {
    std::vector<Waist> waists(directions.size());
    pool_.parallel_for(directions.size(), 1, [&](size_t begin, size_t end, int) {
      for (size_t d = begin; d < end; ++d) waists[d] = waist_along(directions[d]);
    });
    return *std::min_element(waists.begin(), waists.end(),
                             [](const Waist& a, const Waist& b) { return a.ratio < b.ratio; });
  }

 private:
  Waist waist_along(const Vec3d& direction) const {
    const size_t n = points_.size();
    const size_t least =
        std::max(settings_.fewest, static_cast<size_t>(std::ceil(settings_.share * static_cast<double>(n))));
    Waist best;
    if (n < 2 * least || links_.empty()) return best;
    std::vector<double> heights(n);
    for (size_t i = 0; i < n; ++i) heights[i] = dot(direction, points_[i].cast<double>());
    std::vector<uint32_t> order(n), rank(n);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return heights[a] < heights[b]; });
    for (uint32_t r = 0; r < n; ++r) rank[order[r]] = r;
    // cut[t]: weight of the links between the first t Gaussians and the others.
    std::vector<double> cut(n + 1, 0.0);
    for (const Link& link : links_) {
      const auto [low, high] = std::minmax(rank[link.a], rank[link.b]);
      cut[low + 1] += link.weight;
      cut[high + 1] -= link.weight;
    }
    std::partial_sum(cut.begin(), cut.end(), cut.begin());
    std::vector<double> most_after(cut);
    for (size_t t = n; t-- > 0;) most_after[t] = std::max(most_after[t], most_after[t + 1]);
    double most_before = *std::max_element(cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(least));
    for (size_t t = least; t + least <= n; ++t) {
      most_before = std::max(most_before, cut[t]);
      const double widest = std::min(most_before, most_after[t]);
      const double ratio = widest > 0 ? std::max(0.0, cut[t]) / widest : best.ratio;
      if (ratio >= best.ratio) continue;
      best = {ratio, direction, 0.5 * (heights[order[t - 1]] + heights[order[t]])};
    }
    return best;
  }

  std::vector<Vec3f> points_;
  const TouchingObjectSettings& settings_;
  ThreadPool& pool_;
  std::vector<Link> links_;
};

/// The parts of an object, each with its rows.
std::vector<std::vector<uint32_t>> parts_of_object(const GaussianModel& model, std::vector<uint32_t> rows,
                                                   const std::vector<Vec3d>& directions,
                                                   const TouchingObjectSettings& settings, ThreadPool& pool) {
  std::vector<std::vector<uint32_t>> whole, open;
  open.push_back(std::move(rows));
  while (!open.empty()) {
    std::vector<uint32_t> part = std::move(open.back());
    open.pop_back();
    std::vector<Vec3f> points;
    for (const uint32_t i : part) {
      if (opacity_of(model, i) > settings.least_opacity) points.push_back(position_of(model, i).cast<float>());
    }
    const bool may_split = points.size() >= 2 * settings.fewest && whole.size() + open.size() + 1 < settings.most_parts;
    const Waist waist = may_split ? WaistSearch(std::move(points), settings, pool).narrowest(directions) : Waist();
    if (waist.ratio > settings.waist) {
      whole.push_back(std::move(part));
      continue;
    }
    std::vector<uint32_t> sides[2];
    for (const uint32_t i : part) sides[dot(waist.normal, position_of(model, i)) < waist.offset ? 0 : 1].push_back(i);
    open.push_back(std::move(sides[1]));
    open.push_back(std::move(sides[0]));
  }
  return whole;
}

}  // namespace

size_t split_touching_objects(LabelledGaussians& room, const LabelSet& labels, const std::optional<Vec3d>& up,
                              ThreadPool& pool, const TouchingObjectSettings& settings) {
  if (!room.has_labels()) return 0;
  const std::vector<Vec3d> directions = directions_of(up, settings.directions);
  std::map<uint16_t, int> last;  // number of each class
  const std::map<ObjectName, std::vector<uint32_t>> objects = rows_of_objects(room.labels);
  for (const auto& [name, rows] : objects) last[name.first] = std::max<int>(last[name.first], name.second);
  size_t added = 0;
  for (const auto& [name, rows] : objects) {
    const bool in_heaps = std::any_of(std::begin(kInHeaps), std::end(kInHeaps),
                                      [&, label = int(name.first)](const char* n) { return labels.find(n) == label; });
    if (!in_heaps || name.second == 0) continue;
    std::vector<std::vector<uint32_t>> parts = parts_of_object(room.model, rows, directions, settings, pool);
    std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    for (size_t p = 1; p < parts.size() && last[name.first] < kMostInstances; ++p) {
      const uint16_t number = static_cast<uint16_t>(++last[name.first]);
      for (const uint32_t i : parts[p]) room.labels.instance[i] = number;
      ++added;
    }
  }
  return added;
}

}  // namespace aligngs
