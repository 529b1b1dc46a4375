#include "train/photo_labels.h"

#include <algorithm>
#include <cmath>

#include "engine/shared/active_classes.h"
#include "gaussians/label_smoothing.h"
#include "scene/semantic_target.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr int kRanked = 2;            // classes that no teacher ranks among its two best have no say
constexpr double kReach = 0.02;       // / extent: 6 cm in a room; what lies farther apart is not one thing
constexpr double kLeastSeen = 16;     // pixels of a region in a photo that may name it
constexpr float kLeastShare = 1e-4f;  // of a row: a class without votes

/// Writes the shares of the votes as logarithms; rows without votes keep what they have.
void write_rows(const std::vector<float>& votes, const std::vector<uint16_t>& classes, size_t channels,
                ThreadPool& pool, GaussianModel& model) {
  const size_t all = static_cast<size_t>(model.semantic_channels);
  pool.parallel_for(model.size(), 2048, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (size_t k = 0; k < classes.size(); ++k) sum += static_cast<double>(votes[i * channels + k]);
      if (!(sum > 0)) continue;
      float* row = &model.semantics[i * all];
      std::fill_n(row, all, std::log(kLeastShare));
      for (size_t k = 0; k < classes.size(); ++k) {
        row[classes[k]] =
            std::log(std::max(static_cast<float>(static_cast<double>(votes[i * channels + k]) / sum), kLeastShare));
      }
    }
  });
}

/// Votes of the regions, and in how many photos which class has most of them.
RegionEvidence evidence_of(const PhotoOpinions& opinions, const LabelRegions& regions, size_t classes) {
  RegionEvidence e;
  e.classes = classes;
  e.label = regions.label;
  e.area.assign(regions.count, 0.0);
  e.share.assign(regions.count * classes, 0.0);
  e.photos.assign(regions.count * classes, 0);
  std::vector<double> votes(regions.count * classes, 0.0), seen(regions.count, 0.0);
  for (const auto& photo : opinions.of_photo) {
    std::vector<uint32_t> touched;
    for (const PhotoOpinion& o : photo) {
      const uint32_t r = regions.of_gaussian[o.gaussian];
      if (seen[r] == 0) touched.push_back(r);
      seen[r] += static_cast<double>(o.votes);
      e.area[r] += static_cast<double>(o.weight * o.votes);
      for (size_t k = 0; k < PhotoOpinion::kNames; ++k) {
        if (o.channel[k] >= classes) continue;  // the classes without a say
        const double v = static_cast<double>(o.votes * o.share[k]);
        votes[r * classes + o.channel[k]] += v;
        e.share[r * classes + o.channel[k]] += static_cast<double>(o.weight) * v;
      }
    }
    for (const uint32_t r : touched) {
      double* own = &votes[r * classes];
      const double* most = std::max_element(own, own + classes);
      if (seen[r] >= kLeastSeen && *most > 0) ++e.photos[r * classes + static_cast<size_t>(most - own)];
      std::fill_n(own, classes, 0.0);
      seen[r] = 0;
    }
  }
  for (size_t r = 0; r < regions.count; ++r) {
    for (size_t c = 0; c < classes && e.area[r] > 0; ++c) e.share[r * classes + c] /= e.area[r];
  }
  return e;
}

/// A pixel counts with the square of its sum of scores, those that are not taught (data.least_score_sum) too.
void weigh_by_scores(SemanticTarget& target) {
  if (target.score_sum.empty()) return;
  if (target.scale.empty()) normalise_target(target);
  for (size_t i = 0; i < target.scale.size(); ++i) {
    const float sum = target.score_sum[i];
    target.scale[i] *= sum * sum;
    target.confidence[i] = sum > 0 ? 1.0f : 0.0f;
  }
}

/// The votes of a region's Gaussians for other names that some photo has for it become votes for its name.
void join_names(const RegionEvidence& evidence, const std::vector<uint16_t>& names, const LabelRegions& regions,
                size_t channels, std::vector<float>& votes) {
  for (size_t i = 0; i < regions.of_gaussian.size(); ++i) {
    const size_t r = regions.of_gaussian[i];
    if (names[r] == kNoLabel) continue;
    float* own = &votes[i * channels];
    for (size_t c = 0; c < evidence.classes; ++c) {
      if (c == names[r] || (evidence.photos[r * evidence.classes + c] == 0 && c != regions.label[r])) continue;
      own[names[r]] += own[c];
      own[c] = 0;
    }
  }
}

/// Classes that two photos give a Gaussian or that a neighbour has.
OutlineEvidence outlines_of(const PhotoOpinions& opinions, const std::vector<float>& votes,
                            const std::vector<uint16_t>& classes, const NeighbourGraph& graph, double reach,
                            SoftLabels soft, size_t all_classes) {
  constexpr size_t kTop = SoftLabels::kTop;
  constexpr float kLeastOfBest = 0.3f;  // share / that of the commonest: what has less is noise of outlines
  constexpr uint8_t kPhotos = 2;
  OutlineEvidence e;
  e.classes = all_classes;
  const size_t n = soft.size(), channels = static_cast<size_t>(opinions.channels);
  e.area.assign(n, 0.0);
  for (size_t i = 0; i < n; ++i) {
    for (size_t c = 0; c < channels; ++c) e.area[i] += static_cast<double>(votes[i * channels + c]);
  }
  std::vector<uint8_t> photos(n * kTop, 0);
  for (const auto& photo : opinions.of_photo) {
    for (const PhotoOpinion& o : photo) {
      if (o.channel[0] >= classes.size()) continue;
      for (size_t k = kTop * o.gaussian; k < kTop * (o.gaussian + size_t(1)); ++k) {
        if (soft.label[k] == classes[o.channel[0]] && photos[k] < kPhotos) ++photos[k];
      }
    }
  }
  e.allowed.assign(n * kTop, 0);
  for (size_t i = 0; i < n; ++i) {
    e.allowed[kTop * i] = 1;
    for (size_t k = kTop * i + 1; k < kTop * (i + 1) && soft.label[k] != kNoLabel; ++k) {
      if (soft.probability[k] < kLeastOfBest * soft.probability[kTop * i]) continue;
      bool may = photos[k] >= kPhotos;
      for (size_t slot = graph.k * i; slot < graph.k * (i + 1) && !may; ++slot) {
        if (graph.index[slot] == NeighbourGraph::kNone || static_cast<double>(graph.distance[slot]) > reach) break;
        may = soft.label[kTop * graph.index[slot]] == soft.label[k];
      }
      e.allowed[k] = may ? 1 : 0;
    }
  }
  e.soft = std::move(soft);
  return e;
}

/// Nine tenths of the decision and one of the shares, as logarithms.
void write_decisions(const SoftLabels& soft, const std::vector<uint16_t>& label, const std::vector<double>& area,
                     GaussianModel& model) {
  // a smoothed row keeps its decision among like neighbours, and edits still see what was doubtful
  constexpr float kDecided = 0.9f;
  const size_t all = static_cast<size_t>(model.semantic_channels);
  for (size_t i = 0; i < model.size(); ++i) {
    if (!(area[i] > 0) || label[i] == kNoLabel) continue;
    float* row = &model.semantics[i * all];
    std::fill_n(row, all, std::log(kLeastShare));
    for (size_t k = SoftLabels::kTop * i; k < SoftLabels::kTop * (i + 1) && soft.label[k] != kNoLabel; ++k) {
      const float p = (1 - kDecided) * soft.probability[k] + (soft.label[k] == label[i] ? kDecided : 0.0f);
      row[soft.label[k]] = std::log(std::max(p, kLeastShare));
    }
  }
}

}  // namespace

PhotoLabelReport vote_label_rows(GaussianModel& model, PhotoLabelInputs inputs, ThreadPool& pool) {
  PhotoLabelReport report;
  if (model.semantic_channels == 0 || model.size() == 0 || inputs.views.empty()) return report;
  const ActiveClasses active = find_active_classes(inputs.views, kRanked, pool);
  if (active.classes != model.semantic_channels) return report;
  for (TrainingView& view : inputs.views) {
    compress_target(active, pool, view.data.semantics);
    weigh_by_scores(view.data.semantics);
  }
  std::vector<uint16_t> classes = active.active;
  if (!active.has_remainder()) {
    for (int c = 0; c < active.classes; ++c) classes.push_back(static_cast<uint16_t>(c));
  }
  PhotoOpinions opinions = gather_opinions(model, inputs.views, inputs.near_planes, inputs.raster, pool);
  inputs.views.clear();
  if (inputs.calibrate) calibrate_opinions(model.size(), opinions);
  const size_t channels = static_cast<size_t>(opinions.channels);
  std::vector<float> votes = sum_votes(opinions, model.size());
  write_rows(votes, classes, channels, pool, model);

  const LabelSmoother smoother(model, inputs.extent, pool);
  const NeighbourGraph& graph = smoother.graph();
  const SoftLabels soft = smoother.smoothed(model, pool);
  std::vector<uint16_t> label(model.size(), kNoLabel);  // channels
  std::vector<uint16_t> channel_of(static_cast<size_t>(model.semantic_channels), kNoLabel);
  for (size_t k = 0; k < classes.size(); ++k) channel_of[classes[k]] = static_cast<uint16_t>(k);
  for (size_t i = 0; i < model.size(); ++i) {
    const uint16_t best = soft.label[SoftLabels::kTop * i];
    if (best != kNoLabel) label[i] = channel_of[best];
  }
  const LabelRegions regions = connected_regions(label, model, graph, kReach * inputs.extent);
  const RegionEvidence evidence = evidence_of(opinions, regions, classes.size());
  const std::vector<uint16_t> names = name_regions(evidence, inputs.naming);
  for (size_t r = 0; r < regions.count; ++r) {
    report.regions += names[r] != kNoLabel;
    report.renamed += names[r] != regions.label[r];
  }
  join_names(evidence, names, regions, channels, votes);
  write_rows(votes, classes, channels, pool, model);

  const OutlineEvidence outlines =
      outlines_of(opinions, votes, classes, graph, kReach * inputs.extent, smoother.smoothed(model, pool),
                  static_cast<size_t>(model.semantic_channels));
  const std::vector<uint16_t> decided = label_outlines(outlines);
  for (size_t i = 0; i < model.size(); ++i) report.moved += decided[i] != outlines.soft.label[SoftLabels::kTop * i];
  write_decisions(outlines.soft, decided, outlines.area, model);
  report.neighbours = {model.positions, smoother.shared_graph()};
  return report;
}

}  // namespace aligngs
