#include "gaussians/object_naming.h"

#include <algorithm>
#include <numeric>

#include "core/disjoint_sets.h"
#include "gaussians/soft_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr float kFaint = 0.05f;      // opacity below which a Gaussian connects nothing: such ones float between objects
constexpr int kSweeps = 5;           // rooms settle after two
constexpr double kLeastGain = 1e-9;  // of an IoU: below, rounding would decide

/// Expected IoU of every class, kept up while regions change their names.
class ExpectedIou {
 public:
  explicit ExpectedIou(const RegionEvidence& evidence)
      : e_(evidence), called_(e_.classes, 0.0), right_(called_), wanted_(called_) {
    for (size_t r = 0; r < e_.area.size(); ++r) {
      for (size_t c = 0; c < e_.classes; ++c) wanted_[c] += e_.area[r] * e_.share[r * e_.classes + c];
    }
  }
  void add(size_t region, size_t c, double sign) {
    called_[c] += sign * e_.area[region];
    right_[c] += sign * e_.area[region] * e_.share[region * e_.classes + c];
  }
  /// Gain of class c when the region, which nobody has, gets its name.
  double gain(size_t region, size_t c) const {
    const double area = e_.area[region], right = area * e_.share[region * e_.classes + c];
    return ratio(called_[c] + area, right_[c] + right, wanted_[c]) - ratio(called_[c], right_[c], wanted_[c]);
  }

 private:
  static double ratio(double called, double right, double wanted) {
    const double either = called + wanted - right;
    return either > 0 ? right / either : 0;
  }
  const RegionEvidence& e_;
  std::vector<double> called_, right_, wanted_;
};

}  // namespace

LabelRegions connected_regions(const std::vector<uint16_t>& label, const GaussianModel& model,
                               const NeighbourGraph& graph, double reach) {
  const size_t n = label.size(), k = graph.k;
  DisjointSets sets(n);
  for (uint32_t i = 0; i < n; ++i) {
    if (label[i] == kNoLabel || opacity_of(model, i) < kFaint) continue;
    for (size_t slot = k * i; slot < k * (i + 1); ++slot) {
      const uint32_t j = graph.index[slot];
      if (j == NeighbourGraph::kNone || !(static_cast<double>(graph.distance[slot]) <= reach)) break;
      if (label[j] == label[i] && opacity_of(model, j) >= kFaint) sets.unite(i, j);
    }
  }
  LabelRegions regions;
  regions.of_gaussian.resize(n);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t first = sets.find(i);  // the smallest row, numbered before
    if (first == i) regions.label.push_back(label[i]);
    regions.of_gaussian[i] = first == i ? static_cast<uint32_t>(regions.count++) : regions.of_gaussian[first];
  }
  return regions;
}

std::vector<uint16_t> label_outlines(const OutlineEvidence& e, int rounds) {
  constexpr size_t kTop = SoftLabels::kTop;
  const size_t n = e.soft.size();
  std::vector<uint32_t> slot(n, 0);  // of each Gaussian's class
  std::vector<double> wanted(e.classes, 0.0);
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = kTop * i; k < kTop * (i + 1) && e.soft.label[k] != kNoLabel; ++k) {
      wanted[e.soft.label[k]] += e.area[i] * static_cast<double>(e.soft.probability[k]);
    }
  }
  std::vector<uint32_t> best = slot;
  double most = -1;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> called(e.classes, 0.0), right(e.classes, 0.0), iou(e.classes, 0.0), either(e.classes, 0.0);
    for (size_t i = 0; i < n; ++i) {
      const size_t k = kTop * i + slot[i];
      if (e.soft.label[k] == kNoLabel) continue;
      called[e.soft.label[k]] += e.area[i];
      right[e.soft.label[k]] += e.area[i] * static_cast<double>(e.soft.probability[k]);
    }
    double sum = 0;
    for (size_t c = 0; c < e.classes; ++c) {
      either[c] = called[c] + wanted[c] - right[c];
      iou[c] = either[c] > 0 ? right[c] / either[c] : 0;
      sum += iou[c];
    }
    if (sum > most + kLeastGain) most = sum, best = slot;
    bool changed = false;
    for (size_t i = 0; i < n; ++i) {
      uint32_t chosen = slot[i];
      double gain = -1e300;
      for (uint32_t k = 0; k < kTop; ++k) {
        const uint16_t c = e.soft.label[kTop * i + k];
        if (c == kNoLabel) break;
        if (e.allowed[kTop * i + k] == 0 || !(either[c] > 0)) continue;
        const double p = static_cast<double>(e.soft.probability[kTop * i + k]),
                     g = (p * (1 + iou[c]) - iou[c]) / either[c];
        if (g > gain) gain = g, chosen = k;
      }
      changed |= chosen != slot[i];
      slot[i] = chosen;
    }
    if (!changed) break;
  }
  std::vector<uint16_t> label(n);
  for (size_t i = 0; i < n; ++i) label[i] = e.soft.label[kTop * i + best[i]];
  return label;
}

std::vector<uint16_t> name_regions(const RegionEvidence& evidence, const NamingOptions& options) {
  const size_t regions = evidence.area.size(), classes = evidence.classes;
  std::vector<uint16_t> name = evidence.label;
  std::vector<std::vector<uint16_t>> choices(regions);
  std::vector<size_t> contested;
  ExpectedIou iou(evidence);
  for (size_t r = 0; r < regions; ++r) {
    const double* share = &evidence.share[r * classes];
    const size_t own = name[r];
    if (own >= classes) continue;
    iou.add(r, own, 1);
    for (size_t c = 0; c < classes; ++c) {
      if (c == own || evidence.photos[r * classes + c] < options.least_photos ||
          share[c] < options.least_share * share[own])
        continue;
      choices[r].push_back(static_cast<uint16_t>(c));
    }
    if (!choices[r].empty()) contested.push_back(r);
  }
  std::stable_sort(contested.begin(), contested.end(),
                   [&](size_t a, size_t b) { return evidence.area[a] > evidence.area[b]; });
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool changed = false;
    for (const size_t r : contested) {
      iou.add(r, name[r], -1);
      uint16_t best = name[r];
      double most = iou.gain(r, best);
      for (const uint16_t c : choices[r]) {
        const double gain = iou.gain(r, c);
        if (gain > most + kLeastGain) most = gain, best = c;
      }
      changed |= best != name[r];
      name[r] = best;
      iou.add(r, best, 1);
    }
    if (!changed) break;
  }
  return name;
}

}  // namespace aligngs
