// Everything that is measured of a run, as metrics.json has it (metrics_json.h). NaN is a figure that nothing was
// measured for.
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
  bool extrapolates = false;           ///< it looks from where no training view does (view_novelty.h)
  std::optional<RefinedPoseMetrics> pose_refined = {};
};

/// Cost of the training.
struct TrainingMetrics {
  double seconds = kUndefined;
  int64_t iterations = 0;
  uint64_t gaussians = 0;
  double iterations_per_second = kUndefined;
  std::optional<uint64_t> peak_memory_bytes = {};
  std::string device;
};

struct RunMetrics {
  std::string scene_source, priors;  ///< what made them, as the scene says
  int width = 0, height = 0;         ///< pixels at which the run worked
  bool views_measured = false;       ///< false: the mesh alone
  std::vector<TestViewMetrics> views;
  std::string lpips_note;                        ///< its network, or why there is none
  std::optional<SemanticScores> semantics = {};  ///< of rendered labels; empty: no labels or no truth
  std::optional<SemanticScores> teacher = {};    ///< of the network's own labels of the test photos
  std::optional<MeshEvaluation> geometry = {};   ///< empty: no mesh or no truth
  std::optional<MeshLabelScores> mesh_labels = {};
  TrainingMetrics train;
  LabelSet labels;  ///< names of the classes
};

/// "neuris_vertices, all poses, alignment: cameras".
std::string protocol_text(const MeshProtocolResult& result);

/// Mean of a figure over the views that have it; with `extrapolating`, over those that extrapolate or do not. NaN
/// without any.
double mean_over_views(const std::vector<TestViewMetrics>& views, double TestViewMetrics::*figure,
                       std::optional<bool> extrapolating = {});
/// The same of a figure after the fit of the poses.
double mean_over_views(const std::vector<TestViewMetrics>& views, double RefinedPoseMetrics::*figure);

}  // namespace aligngs
