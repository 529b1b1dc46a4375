// Everything that is measured of a run, as metrics.json has it (metrics_json.h). NaN, or no value, is a figure that
// nothing was measured for, or that an older file does not have.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metrics/mesh_protocols.h"
#include "metrics/semantic_metrics.h"
#include "metrics/undefined.h"
#include "scene/label_set.h"

namespace aligngs {

/// Distance of a pose from the true one.
struct PoseError {
  double metres = 0, degrees = 0;
};

/// A test view once more, with its pose fitted to the photo itself and the scene frozen.
struct RefinedPoseMetrics {
  double psnr = kUndefined;  ///< dB
  double ssim = kUndefined;
  double shift = 0;                      ///< scene units that the centre moved
  double turn_degrees = 0;               ///< that the camera turned
  std::optional<PoseError> before = {};  ///< the fit; empty without true cameras
  std::optional<PoseError> after = {};
};

struct TestViewMetrics {
  std::string name;
  double psnr = kUndefined;  ///< dB
  double ssim = kUndefined;
  double lpips = kUndefined;       ///< inputs in [-1, 1]
  double lpips_unit = kUndefined;  ///< inputs left in [0, 1]
  double psnr_exposure_fitted = kUndefined;
  double label_accuracy = kUndefined;  ///< share of labelled pixels in [0, 1]
  /// It looks from where no training view does (view_novelty.h). False as well where an older file does not say.
  bool extrapolates = false;
  std::optional<RefinedPoseMetrics> pose_refined = {};
};

/// Means over the test views that interpolate the training views, or extrapolate them.
struct ViewGroupMetrics {
  double psnr = kUndefined;  ///< dB
  double ssim = kUndefined;
  size_t views = 0;
};

/// Over the test views with their poses fitted to the photos.
struct RefinedPoseSummary {
  double psnr = kUndefined;  ///< dB
  double ssim = kUndefined;
  double median_error_before = kUndefined;  ///< metres of the poses from the true ones, without the fit
  double median_error_after = kUndefined;
};

/// Means over the test views that have the figure.
struct NovelViewMetrics {
  double psnr = kUndefined;  ///< dB
  double ssim = kUndefined;
  double lpips = kUndefined;       ///< inputs in [-1, 1]
  double lpips_unit = kUndefined;  ///< inputs left in [0, 1]
  double psnr_exposure_fitted = kUndefined;
  std::string lpips_note;  ///< its network, or why there is none
  size_t views = 0;
  std::optional<ViewGroupMetrics> interpolating = {}, extrapolating = {};  ///< empty: an older file
  std::optional<RefinedPoseSummary> pose_refined = {};                     ///< empty: no pose was fitted
};

/// Cost of the training.
struct TrainingMetrics {
  double seconds = kUndefined;
  std::optional<uint64_t> iterations = {}, gaussians = {};
  double iterations_per_second = kUndefined;
  std::optional<uint64_t> peak_memory_bytes = {};
  std::string device;
};

struct RunMetrics {
  std::string scene_source, priors;                  ///< what made them, as the scene says
  int width = 0, height = 0;                         ///< pixels at which the run worked
  std::optional<NovelViewMetrics> novel_views = {};  ///< empty: the mesh alone was measured
  std::vector<TestViewMetrics> views;
  std::optional<SemanticScores> semantics = {};  ///< of rendered labels; empty: no labels or no truth
  std::optional<SemanticScores> teacher = {};    ///< of the network's own labels of the test photos
  std::optional<MeshEvaluation> geometry = {};   ///< empty: no mesh or no truth
  std::optional<MeshLabelScores> mesh_labels = {};
  TrainingMetrics train;
  LabelSet labels;  ///< names of the classes
};

/// "neuris_vertices, all poses, alignment: cameras", or the words of an older file.
std::string protocol_text(const MeshProtocolResult& result);

/// The means and medians over the views; NaN without a view that has the figure.
NovelViewMetrics novel_view_metrics(const std::vector<TestViewMetrics>& views, std::string lpips_note);

/// F-score at one of the finer distances, in metres; NaN where it was not measured.
double finer_fscore(const MeshScores& scores, double threshold);

}  // namespace aligngs
