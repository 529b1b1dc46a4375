#include "metrics/semantic_metrics.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "metrics/point_index.h"
#include "metrics/surface_points.h"
#include "metrics/undefined.h"

namespace aligngs {

ConfusionMatrix::ConfusionMatrix(int classes) : classes_(classes), counts_(size_t(classes) * (classes + 1), 0) {}

void ConfusionMatrix::add(uint16_t truth, uint16_t predicted) {
  if (truth == kNoLabel) return;
  if (truth >= classes_) {
    throw_bad_input({}, "true label", fmt::format("class {} does not exist, there are {} classes", truth, classes_),
                    "check labels.csv against the label maps in truth/");
  }
  const int column = predicted < classes_ ? predicted : classes_;
  ++counts_[size_t(truth) * (classes_ + 1) + column];
}

void ConfusionMatrix::add(const Image<uint16_t>& truth, const Image<uint16_t>& predicted) {
  if (truth.width != predicted.width || truth.height != predicted.height) {
    throw_bad_input({}, "label map size",
                    fmt::format("labels of {}x{} cannot be compared with true labels of {}x{}", predicted.width,
                                predicted.height, truth.width, truth.height));
  }
  for (size_t i = 0; i < truth.pixels(); ++i) add(truth.data[i], predicted.data[i]);
}

uint64_t ConfusionMatrix::of_class(int truth) const {
  uint64_t sum = 0;
  for (int p = 0; p <= classes_; ++p) sum += count(truth, p);
  return sum;
}

SemanticScores ConfusionMatrix::scores(double min_share) const {
  SemanticScores scores;
  scores.iou.assign(classes_, kUndefined);
  scores.present_iou.assign(classes_, kUndefined);
  std::vector<uint64_t> in_truth(classes_, 0), in_prediction(classes_, 0);
  uint64_t right = 0;
  for (int t = 0; t < classes_; ++t) {
    in_truth[t] = of_class(t);
    for (int p = 0; p < classes_; ++p) in_prediction[p] += count(t, p);
    right += count(t, t);
    scores.samples += in_truth[t];
  }
  double sum = 0, present_sum = 0;
  for (int c = 0; c < classes_; ++c) {
    if (in_truth[c] == 0) continue;
    const uint64_t both = count(c, c);
    const double iou = static_cast<double>(both) / static_cast<double>(in_truth[c] + in_prediction[c] - both);
    scores.present_iou[c] = iou;
    present_sum += iou;
    ++scores.present_classes;
    if (static_cast<double>(in_truth[c]) < min_share * static_cast<double>(scores.samples)) continue;
    scores.iou[c] = iou;
    sum += iou;
    ++scores.classes;
  }
  scores.miou = scores.classes ? sum / scores.classes : kUndefined;
  scores.present_miou = scores.present_classes ? present_sum / scores.present_classes : kUndefined;
  scores.accuracy = scores.samples ? static_cast<double>(right) / static_cast<double>(scores.samples) : kUndefined;
  return scores;
}

MeshLabelScores compare_mesh_labels(const TriangleMesh& predicted, const TriangleMesh& truth, int classes,
                                    ThreadPool& pool, const MeshLabelOptions& options) {
  const TriangleMesh* meshes[] = {&predicted, &truth};
  for (const TriangleMesh* mesh : meshes) {
    if (mesh->labels.size() != mesh->vertices.size()) {
      throw_bad_input(
          {}, "label",
          mesh == &truth ? "the true mesh has no label per vertex" : "the predicted mesh has no label per vertex");
    }
  }
  const LabelledPoints points = thin_labelled(truth.vertices, truth.labels, options.voxel);
  const PointIndex index(predicted.vertices);
  const std::vector<Nearest> nearest = index.nearest(points.positions, pool);
  ConfusionMatrix all(classes), covered(classes);
  for (size_t i = 0; i < nearest.size(); ++i) {
    const bool near = nearest[i].distance < options.threshold;
    const uint16_t label = near ? predicted.labels[nearest[i].index] : kNoLabel;
    all.add(points.labels[i], label);
    if (near) covered.add(points.labels[i], label);
  }
  MeshLabelScores scores;
  scores.all = all.scores(options.min_share);
  scores.covered = covered.scores(options.min_share);
  scores.coverage = scores.all.samples
                        ? static_cast<double>(scores.covered.samples) / static_cast<double>(scores.all.samples)
                        : kUndefined;
  for (int c = 0; c < classes; ++c) {
    const bool counts = std::isfinite(scores.all.iou[static_cast<size_t>(c)]);
    scores.class_coverage.push_back(
        counts ? static_cast<double>(covered.of_class(c)) / static_cast<double>(all.of_class(c)) : kUndefined);
  }
  return scores;
}

}  // namespace aligngs
