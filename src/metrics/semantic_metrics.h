// How right the labels are: rendered label maps against true ones, and mesh labels against a labelled true mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// NaN (JSON null) where nothing was labelled. Two rules choose the classes of the mean: those with a least share of
/// the labelled pixels ("count"), and all classes of the truth ("present"). The second weighs small objects as much as
/// the wall.
struct SemanticScores {
  double miou = 0;                  ///< mean over the classes that count
  double present_miou = 0;          ///< mean over the classes present in the truth
  double accuracy = 0;              ///< share of labelled pixels (points) with the right class
  int classes = 0;                  ///< number of classes that count in miou
  int present_classes = 0;          ///< number of classes that present_miou is the mean over
  uint64_t samples = 0;             ///< labelled pixels (points)
  std::vector<double> iou;          ///< per class; NaN where the class does not count
  std::vector<double> present_iou;  ///< per class; NaN where the truth has none of it
};

/// Share of the labelled pixels (points) from which a class counts.
inline constexpr double kLeastClassShare = 0.001;

/// Counts true class x predicted class, pooled over views. A prediction of kNoLabel (or of no class that exists) is
/// wrong wherever the truth has a label; pixels whose truth is kNoLabel are ignored.
class ConfusionMatrix {
 public:
  explicit ConfusionMatrix(int classes);

  /// Error{kBadInput} when a true label is neither a class nor kNoLabel.
  void add(uint16_t truth, uint16_t predicted);
  void add(const Image<uint16_t>& truth, const Image<uint16_t>& predicted);

  int classes() const { return classes_; }
  /// predicted == classes() is "none".
  uint64_t count(int truth, int predicted) const { return counts_[size_t(truth) * (classes_ + 1) + predicted]; }
  /// Labelled pixels (points) of a true class, whatever is predicted.
  uint64_t of_class(int truth) const;

  /// IoU = TP / (TP + FP + FN) over labelled pixels. A class counts when it holds at least `min_share` of them (0.1 %):
  /// a few stray pixels must not weigh as much as the wall. It is present when it holds any.
  SemanticScores scores(double min_share = kLeastClassShare) const;

 private:
  int classes_;
  std::vector<uint64_t> counts_;  // classes x (classes + 1)
};

struct MeshLabelOptions {
  double threshold = 0.05;  ///< metres (units of the truth): how far the nearest predicted vertex may be
  double voxel = 0.02;      ///< truth vertices are thinned to one per voxel: the majority label is kept
  double min_share = kLeastClassShare;
};

struct MeshLabelScores {
  SemanticScores all;      ///< a truth vertex without predicted surface nearby counts as wrong
  SemanticScores covered;  ///< only truth vertices with a predicted vertex within the threshold
  double coverage = 0;     ///< share of truth vertices with a predicted vertex within the threshold
  /// the same of each class, NaN of those that `all` leaves out: lamps and legs are what meshes lose
  std::vector<double> class_coverage;
};

/// For each thinned, labelled vertex of `truth` the label of the nearest vertex of `predicted`. Both in the same
/// world; pass a truth mesh culled to what the views see. Meshes without labels: Error{kBadInput}.
MeshLabelScores compare_mesh_labels(const TriangleMesh& predicted, const TriangleMesh& truth, int classes,
                                    ThreadPool& pool, const MeshLabelOptions& options = {});

}  // namespace aligngs
