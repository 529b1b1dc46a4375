// The figures by which a simulated scene is accepted: does its teacher err like a real network?
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "synth/synth_scene.h"

namespace aligngs {

/// One measured figure and the range real networks fall into (docs/quality.md; medium level only).
struct AcceptanceFigure {
  std::string name;
  double value = 0;
  std::string unit;
  std::optional<double> low, high;  ///< accepted range; absent: for information
  bool accepted() const { return (!low || value >= *low) && (!high || value <= *high); }
};

/// On the validation photos of ADE20K, by the publisher: 50.6.
inline constexpr double kEomtPanopticQuality = 0.506;

struct AcceptanceReport {
  std::string teacher;                               ///< e.g. "simulated feed-forward (medium)"
  std::optional<PublishedGeometry> published;        ///< of the network that the level imitates
  std::optional<double> published_panoptic_quality;  ///< of the network that gives the segments; nothing without any
  std::vector<AcceptanceFigure> figures;
  bool accepted() const;  ///< every figure with a range is inside it
  /// The figure's value; throws Error{kFailed} when there is none of that name.
  double value(const std::string& name) const;
  /// One line per figure: name, value, range, "ok" or "outside".
  std::string table() const;
};

/// Figure by figure the mean over several scenes: the ranges are meant for the mean over some ten rooms, a single
/// scene may lie outside. Figures that not all reports have are left out. Empty input: no figures.
AcceptanceReport mean_acceptance(const std::vector<AcceptanceReport>& reports);

/// Measures everything that needs no training:
/// - fused points of the training views' depth (the 70 % most confident pixels of each view) against the true surface
///   that these views see. Measured after the similarity that fits corresponding points best: accuracy mean and median,
///   completeness mean (cm). The published completeness is of few views, so it is measured on groups of four; `on
///   cameras`: after the similarity of the cameras (for information);
/// - pair pose error: over pairs of training views, the larger of rotation and direction-of-translation error. Its mean
///   is clipped at 3 degrees as AUC@3 does; the area under its curve goes up to 30 degrees;
/// - rank correlation of confidence with the depth error that the view itself has;
/// - mono depth: RMSE (m) and Pearson correlation, per view, mean;
/// - semantics: pixel accuracy, mIoU of classes with >= 0.1 % of the pixels, accuracy within 3 px of a label edge. Also
///   the share of wrong pixels that are wrong in most views that see the point;
/// - segments: panoptic quality (teacher_panoptic.h) of all views;
/// - the room: share of bare surface, of far test pixels that training saw, of surface seen twice.
/// Ranges are given for the medium level of the simulated teacher only. Deterministic.
AcceptanceReport measure_acceptance(const SynthScene& scene, ThreadPool& pool);

}  // namespace aligngs
