// The numbers of a run by the names that they have in metrics.json, for people who name one.
#include <cmath>
#include <type_traits>
#include <utility>

#include "metrics/metric_names.h"
#include "metrics/metrics_json.h"

namespace aligngs {
namespace {

/// Takes numbers of a part under its name; leaves out those that were not measured.
class FigureList {
 public:
  FigureList(std::map<std::string, double>& figures, std::string part)
      : figures_(figures), part_(std::move(part) + ".") {}

  void operator()(const std::string& name, double value) const {
    if (std::isfinite(value)) figures_[part_ + name] = value;
  }
  template <class Integer>
  requires std::is_integral_v<Integer>
  void operator()(const std::string& name, Integer value) const { figures_[part_ + name] = static_cast<double>(value); }
  void operator()(const std::string& name, const std::optional<uint64_t>& value) const {
    if (value) figures_[part_ + name] = static_cast<double>(*value);
  }
  FigureList within(const std::string& name) const { return {figures_, part_ + name}; }
  void by_class(const std::string& name, const std::vector<double>& values, const LabelSet& labels) const {
    const FigureList classes = within(name);
    for (size_t c = 0; c < values.size() && c < labels.classes.size(); ++c) classes(labels.classes[c].name, values[c]);
  }

 private:
  std::map<std::string, double>& figures_;
  std::string part_;
};

void add_semantics(const FigureList& part, const SemanticScores& scores, const LabelSet& labels) {
  each_semantic_number(scores, part);
  each_present_number(scores, part.within("present"));
  part.by_class("iou", scores.iou, labels);
  part.within("present").by_class("iou", scores.present_iou, labels);
}

void add_novel_views(const FigureList& nvs, const NovelViewMetrics& means) {
  each_novel_view_number(means, nvs);
  nvs.within("exposure_fitted")("psnr", means.psnr_exposure_fitted);
  if (means.interpolating) each_view_group_number(*means.interpolating, nvs.within("interpolating"));
  if (means.extrapolating) each_view_group_number(*means.extrapolating, nvs.within("extrapolating"));
  if (means.pose_refined) each_refined_summary_number(*means.pose_refined, nvs.within("pose_refined"));
}

void add_geometry(const FigureList& geometry, const MeshEvaluation& evaluation) {
  const MeshProtocolResult& headline = evaluation.headline;
  each_mesh_number(headline, geometry);
  for (const ThresholdScores& finer : headline.scores.finer) each_finer_number(finer, geometry);
  if (headline.alignment_report.icp) geometry("icp_rmse_m", headline.alignment_report.icp->rmse_after);
  each_surface_number(evaluation.surface, geometry.within("surface"));
}

}  // namespace

std::map<std::string, double> named_figures(const RunMetrics& metrics) {
  std::map<std::string, double> figures;
  if (metrics.novel_views) add_novel_views({figures, "nvs"}, *metrics.novel_views);
  if (metrics.geometry) add_geometry({figures, "geometry"}, *metrics.geometry);
  const FigureList semantics(figures, "semantics");
  if (metrics.semantics) add_semantics(semantics, *metrics.semantics, metrics.labels);
  if (metrics.teacher) add_semantics(semantics.within("teacher"), *metrics.teacher, metrics.labels);
  if (metrics.mesh_labels) {
    const FigureList mesh = semantics.within("mesh");
    add_semantics(mesh, metrics.mesh_labels->all, metrics.labels);
    each_mesh_label_number(*metrics.mesh_labels, mesh);
    mesh.by_class("class_coverage", metrics.mesh_labels->class_coverage, metrics.labels);
  }
  each_training_number(metrics.train, FigureList(figures, "train"));
  return figures;
}

}  // namespace aligngs
