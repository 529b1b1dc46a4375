#include "train/photo_labels.h"

#include <algorithm>
#include <cmath>

#include "engine/cpu/active_classes.h"
#include "gaussians/object_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr int kRanked = 2;               // classes that no teacher ranks among its two best have no say
constexpr size_t kNeighbours = 16;       // as where labels are smoothed: the ring around a Gaussian on a surface, and the next one
constexpr double kReach = 0.02;          // / extent: 6 cm in a room; what lies farther apart is not one thing
constexpr double kLeastSeen = 16;        // pixels of a region in a photo that may name it
constexpr float kLeastShare = 1e-4f;     // of a row: a class without votes

/// Writes the shares of the votes as logarithms; rows without votes keep what they have.
void write_rows(const std::vector<float>& votes, const std::vector<uint16_t>& classes, size_t channels, ThreadPool& pool, GaussianModel& model) {
  const size_t all = static_cast<size_t>(model.semantic_channels);
  pool.parallel_for(model.size(), 2048, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (size_t k = 0; k < classes.size(); ++k) sum += static_cast<double>(votes[i * channels + k]);
      if (!(sum > 0)) continue;
      float* row = &model.semantics[i * all];
      std::fill_n(row, all, std::log(kLeastShare));
      for (size_t k = 0; k < classes.size(); ++k) {
        row[classes[k]] = std::log(std::max(static_cast<float>(static_cast<double>(votes[i * channels + k]) / sum), kLeastShare));
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
      if (seen[r] >= kLeastSeen) ++e.photos[r * classes + static_cast<size_t>(std::max_element(own, own + classes) - own)];
      std::fill_n(own, classes, 0.0);
      seen[r] = 0;
    }
  }
  for (size_t r = 0; r < regions.count; ++r) {
    for (size_t c = 0; c < classes && e.area[r] > 0; ++c) e.share[r * classes + c] /= e.area[r];
  }
  return e;
}

}  // namespace

PhotoLabelReport vote_label_rows(GaussianModel& model, PhotoLabelInputs inputs, ThreadPool& pool) {
  PhotoLabelReport report;
  if (model.semantic_channels == 0 || model.size() == 0 || inputs.views.empty()) return report;
  const cpu::ActiveClasses active = cpu::find_active_classes(inputs.views, kRanked, pool);
  if (active.classes != model.semantic_channels) return report;
  for (TrainingView& view : inputs.views) cpu::compress_target(active, pool, view.data.semantics);
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

  const SoftLabels soft = smoothed_labels(model, inputs.extent, pool);
  std::vector<uint16_t> label(model.size(), kNoLabel);  // channels
  std::vector<uint16_t> channel_of(static_cast<size_t>(model.semantic_channels), kNoLabel);
  for (size_t k = 0; k < classes.size(); ++k) channel_of[classes[k]] = static_cast<uint16_t>(k);
  for (size_t i = 0; i < model.size(); ++i) {
    const uint16_t best = soft.label[SoftLabels::kTop * i];
    if (best != kNoLabel) label[i] = channel_of[best];
  }
  const NeighbourGraph graph = neighbour_graph(positions_of(model), kNeighbours, pool);
  const LabelRegions regions = connected_regions(label, model, graph, kReach * inputs.extent);
  const RegionEvidence evidence = evidence_of(opinions, regions, classes.size());
  const std::vector<uint16_t> names = name_regions(evidence, inputs.naming);
  for (size_t r = 0; r < regions.count; ++r) {
    report.regions += names[r] != kNoLabel;
    report.renamed += names[r] != regions.label[r];
  }
  for (size_t i = 0; i < model.size(); ++i) {
    const uint16_t name = names[regions.of_gaussian[i]];
    if (name == kNoLabel || label[i] == kNoLabel || label[i] == name) continue;
    float &from = votes[i * channels + label[i]], &to = votes[i * channels + name];
    to += from;
    from = 0;
  }
  write_rows(votes, classes, channels, pool, model);
  return report;
}

}  // namespace aligngs
