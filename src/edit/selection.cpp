#include "edit/selection.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "edit/absent_objects.h"
#include "edit/crumbs.h"
#include "gaussians/object_labels.h"
#include "gaussians/point_tree.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr float kFaint = 0.01f;  ///< probabilities below say nothing about where a histogram splits

/// Answers "which object of this class is Gaussian i part of?" also for Gaussians whose best class is another one.
class ObjectFinder {
 public:
  ObjectFinder(const LabelledGaussians& room, int label, double reach)
      : room_(room), label_(label), reach_(reach), tree_(members()) {}

  bool any() const { return !rows_.empty(); }
  /// 0: none within reach. A class without numbered objects has the object 0 everywhere.
  int object_of(size_t i, std::vector<PointTree::Neighbour>& scratch) const {
    if (room_.labels.label[i] == label_ && room_.labels.instance[i]) return room_.labels.instance[i];
    const float* p = &room_.model.positions[3 * i];
    tree_.nearest({p[0], p[1], p[2]}, 1, scratch);
    return scratch.empty() || scratch[0].distance > reach_ ? 0 : room_.labels.instance[rows_[scratch[0].index]];
  }

 private:
  std::vector<Vec3f> members() {
    std::vector<Vec3f> points;
    for (uint32_t i = 0; i < room_.labels.label.size(); ++i) {
      if (room_.labels.label[i] != label_ || room_.labels.instance[i] == 0) continue;
      rows_.push_back(i);
      points.push_back(
          {room_.model.positions[3 * i], room_.model.positions[3 * i + 1], room_.model.positions[3 * i + 2]});
    }
    return points;
  }

  const LabelledGaussians& room_;
  int label_;
  double reach_;
  std::vector<uint32_t> rows_;
  PointTree tree_;
};

/// Probability that decides, per Gaussian, and the threshold for it.
struct Criterion {
  std::vector<float> value;
  double threshold = 0;
};

Criterion criterion_of(const LabelledGaussians& room, int label, const std::vector<SelectionTerm>& terms,
                       const ThresholdRule& rule) {
  Criterion out;
  out.value.assign(room.model.size(), 0.f);
  std::vector<int> classes = {label};
  if (rule.kind ==
      ThresholdRule::Kind::kValue) {  // the named classes together: a pillow that may be a cushion is one of the two
    classes.clear();
    for (const SelectionTerm& term : terms) {
      if (term.named.empty()) classes.push_back(term.label);
    }
    std::sort(classes.begin(), classes.end());
    classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
  }
  for (size_t i = 0; i < out.value.size(); ++i) {
    if (rule.kind == ThresholdRule::Kind::kArgmax) {
      out.value[i] = room.labels.label[i] == label ? 1.f : 0.f;
    } else {
      for (const int c : classes) out.value[i] += room.soft.of(i, c);
    }
  }
  if (rule.kind == ThresholdRule::Kind::kArgmax) {
    out.threshold = 1;
  } else if (rule.kind == ThresholdRule::Kind::kValue) {
    out.threshold = rule.value;
  } else {
    std::vector<float> informative;
    for (const float p : out.value) {
      if (p > kFaint) informative.push_back(p);
    }
    out.threshold = otsu_threshold(informative);
  }
  return out;
}

/// Whether any thing of the room has a number. Gaussians without one are crumbs then, and names do not mean them.
bool has_numbers(const LabelledGaussians& room) {
  return std::any_of(room.labels.instance.begin(), room.labels.instance.end(), [](uint16_t number) { return number; });
}

void mark(const LabelledGaussians& room, const std::vector<SelectionTerm>& terms, const ThresholdRule& rule,
          const SelectionOptions& options, uint8_t value, GaussianSelection& selection) {
  for (const SelectionTerm& term : terms) {
    if (!term.named.empty()) continue;
    const Criterion criterion = criterion_of(room, term.label, terms, rule);
    if (rule.kind != ThresholdRule::Kind::kArgmax && selection.threshold == 0)
      selection.threshold = criterion.threshold;
    const ObjectFinder finder(room, term.label, options.reach * room.extent);
    if (!finder.any() && rule.kind == ThresholdRule::Kind::kArgmax && has_numbers(room)) continue;
    std::vector<PointTree::Neighbour> scratch;
    for (size_t i = 0; i < selection.mask.size(); ++i) {
      if (!(criterion.value[i] >= criterion.threshold) || selection.mask[i] == value) continue;
      const int object = finder.any() ? finder.object_of(i, scratch) : 0;
      const bool wanted = term.instance ? object == term.instance : object != 0 || !finder.any();
      if (wanted) selection.mask[i] = value;
    }
  }
}

bool has_class(const std::vector<SelectionTerm>& terms) {
  return std::any_of(terms.begin(), terms.end(), [](const SelectionTerm& t) { return t.named.empty(); });
}

void mark_drawn(const std::vector<SelectionTerm>& terms, uint8_t value, std::vector<uint8_t>& mask) {
  for (const SelectionTerm& term : terms) {
    for (size_t i = 0; term.rows && i < mask.size(); ++i) {
      if ((*term.rows)[i]) mask[i] = value;
    }
  }
}

/// Adds what was drawn by hand. Nothing is cleaned there: a person drew its edge.
void add_drawn(const LabelledGaussians& room, const SelectionQuery& query, const ThresholdRule& rule,
               const SelectionOptions& options, GaussianSelection& selection) {
  GaussianSelection drawn;
  drawn.mask.assign(selection.mask.size(), 0);
  mark_drawn(query.include, 1, drawn.mask);
  mark(room, query.exclude, rule, options, 0, drawn);
  for (size_t i = 0; i < drawn.mask.size(); ++i) selection.mask[i] |= drawn.mask[i];
  mark_drawn(query.exclude, 0, selection.mask);
}

/// Rows in the box around the marked ones, which is `reach` wider. Others do not join a selection: what is that far
/// from it has no neighbours of its own.
std::vector<uint32_t> rows_around(const std::vector<Vec3f>& points, const std::vector<uint8_t>& marked, float reach) {
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  for (size_t i = 0; i < points.size(); ++i) {
    for (int a = 0; marked[i] && a < 3; ++a) {
      low[a] = std::min(low[a], points[i][a] - reach);
      high[a] = std::max(high[a], points[i][a] + reach);
    }
  }
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = points[i];
    if (p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z)
      rows.push_back(i);
  }
  return rows;
}

/// Majority of the neighbours with hysteresis, counted by opacity.
void clean(const LabelledGaussians& room, const SelectionOptions& options, ThreadPool& pool,
           std::vector<uint8_t>& mask) {
  const size_t k = static_cast<size_t>(std::max(0, options.neighbours));
  if (k == 0 || mask.size() <= k) return;
  const std::vector<Vec3f> points = positions_of(room.model);
  const std::vector<uint32_t> rows = rows_around(points, mask, static_cast<float>(options.reach * room.extent));
  const NeighbourGraph graph = neighbour_graph(points, rows, k, pool);
  for (int round = 0; round < options.rounds; ++round) {
    const std::vector<uint8_t> before = mask;
    for (size_t n = 0; n < rows.size(); ++n) {
      const uint32_t i = rows[n];
      double chosen = 0, all = 0;
      for (size_t slot = k * n; slot < k * (n + 1); ++slot) {
        const double weight = opacity_of(room.model, graph.index[slot]);
        all += weight;
        if (before[graph.index[slot]]) chosen += weight;
      }
      if (!before[i] && chosen >= options.join * all) mask[i] = 1;
      if (before[i] && chosen <= options.leave * all) mask[i] = 0;
    }
  }
}

GaussianLabels no_labels(const GaussianModel& model, const LabelSet& labels) {
  GaussianLabels out;
  out.label_set = labels.name;
  out.label.assign(model.size(), kNoLabel);
  out.instance.assign(model.size(), 0);
  out.confidence.assign(model.size(), 0);
  return out;
}

}  // namespace

LabelledGaussians label_objects(GaussianModel model, const LabelSet& labels, double extent, ThreadPool& pool) {
  LabelledGaussians room;
  room.extent = extent > 0 ? extent : extent_of(model);
  if (model.semantic_channels > 0) {
    ObjectLabels objects = object_labels(model, labels, room.extent, pool);
    room.soft = std::move(objects.soft);
    room.labels = std::move(objects.labels);
  } else {
    room.labels = no_labels(model, labels);
  }
  room.model = std::move(model);
  join_crumbs(room, {}, pool);
  return room;
}

double otsu_threshold(const std::vector<float>& values) {
  constexpr int kBins = 256;
  std::vector<double> count(kBins, 0.0);
  for (const float v : values) count[std::clamp(static_cast<int>(v * kBins), 0, kBins - 1)] += 1;
  double total = 0, sum = 0;
  for (int b = 0; b < kBins; ++b) {
    total += count[b];
    sum += b * count[b];
  }
  double below = 0, below_sum = 0, best = 0, threshold = 0.5;
  for (int b = 0; b + 1 < kBins; ++b) {
    below += count[b];
    below_sum += b * count[b];
    if (below == 0 || below == total) continue;
    const double gap = below_sum / below - (sum - below_sum) / (total - below);
    const double between = below * (total - below) * gap * gap;
    if (between > best) {
      best = between;
      threshold = static_cast<double>(b + 1) / kBins;
    }
  }
  return threshold;
}

GaussianSelection select_gaussians(const LabelledGaussians& room, const SelectionQuery& query,
                                   const ThresholdRule& rule, const LabelSet& labels, const SelectionOptions& options,
                                   ThreadPool& pool) {
  if (!room.has_labels() && (has_class(query.include) || has_class(query.exclude))) {
    throw_bad_input({}, "--select", "this run was trained without semantics, so that no object has a name",
                    "select everything, or train a scene that has segmentation_logits/");
  }
  GaussianSelection selection;
  selection.mask.assign(room.model.size(), query.everything ? 1 : 0);
  mark(room, query.include, rule, options, 1, selection);
  mark(room, query.exclude, rule, options, 0, selection);
  const auto is_empty = [&] {
    return std::find(selection.mask.begin(), selection.mask.end(), uint8_t(1)) == selection.mask.end();
  };
  if (!is_empty()) {
    const std::vector<uint8_t> named = selection.mask;
    clean(room, options, pool, selection.mask);
    if (is_empty()) selection.mask = named;  // of a few Gaussians among others: whoever names a speck means it
  }
  add_drawn(room, query, rule, options, selection);
  std::map<std::pair<int, int>, size_t> counts;
  for (size_t i = 0; i < selection.mask.size(); ++i) {
    if (!selection.mask[i]) continue;
    ++selection.count;
    const uint16_t label = room.labels.label[i];
    ++counts[{label == kNoLabel ? -1 : label, label == kNoLabel ? 0 : room.labels.instance[i]}];
  }
  for (const auto& [key, gaussians] : counts) selection.objects.push_back({key.first, key.second, gaussians});
  if (selection.count == 0 && !query.include.empty() && !has_class(query.include)) {
    throw_bad_input({}, "--select", "nothing of \"" + selection_text(query, labels) + "\" is left in the room",
                    "undo the edit that took it away, or select something else");
  }
  if (selection.count == 0) {
    throw_bad_input({}, "--select", "the room has no object that is \"" + selection_text(query, labels) + "\"",
                    held_instead(list_instances(room.model, room.labels), query.include, labels));
  }
  return selection;
}

}  // namespace aligngs
