#include "metrics/metrics_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "metrics/metric_names.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

Json written(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
template <class Integer>
Json written(Integer value) {
  return Json(value);
}
template <class Integer>
Json written(const std::optional<Integer>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Takes the numbers of a part.
auto into(Json& json) {
  return [&json](const std::string& name, const auto& value) { json[name] = written(value); };
}

/// The finite values by the names of their classes.
Json by_class(const std::vector<double>& values, const LabelSet& labels) {
  Json json = Json::object();
  for (int c = 0; c < labels.size(); ++c) {
    if (std::isfinite(values[size_t(c)])) json[labels.classes[size_t(c)].name] = values[size_t(c)];
  }
  return json;
}

Json semantic_json(const SemanticScores& scores, const LabelSet& labels) {
  Json present = {{"iou", by_class(scores.present_iou, labels)}};
  each_present_number(scores, into(present));
  Json json = {{"rule", fmt::format("mean over the classes with at least {:g} % of the labelled samples; present: over "
                                    "all classes of the truth",
                                    100 * kLeastClassShare)},
               {"iou", by_class(scores.iou, labels)},
               {"present", present}};
  each_semantic_number(scores, into(json));
  return json;
}

Json mesh_label_json(const MeshLabelScores& scores, const LabelSet& labels) {
  Json json = semantic_json(scores.all, labels);
  each_mesh_label_number(scores, into(json));
  json["class_coverage"] = by_class(scores.class_coverage, labels);
  return json;
}

/// Labels of views, with those of the teacher and of the mesh; null without any.
Json all_semantics_json(const RunMetrics& m) {
  Json json = m.semantics ? semantic_json(*m.semantics, m.labels) : Json(nullptr);
  // The yardstick of the training: the teacher run on the test photos themselves.
  if (m.teacher) json["teacher"] = semantic_json(*m.teacher, m.labels);
  if (!m.mesh_labels) return json;
  if (json.is_null()) json = {{"miou", nullptr}, {"accuracy", nullptr}, {"present", {{"miou", nullptr}}}};
  json["mesh"] = mesh_label_json(*m.mesh_labels, m.labels);
  return json;
}

Json pose_error_json(const PoseError& error) {
  Json json;
  each_pose_error_number(error, into(json));
  return json;
}

Json view_json(const TestViewMetrics& view) {
  Json json = {{"name", view.name}, {"extrapolates", view.extrapolates}};
  each_view_number(view, into(json));
  if (!view.pose_refined) return json;
  const RefinedPoseMetrics& refined = *view.pose_refined;
  Json& fit = json["pose_refined"];
  each_refined_pose_number(refined, into(fit));
  if (refined.before) fit["error_before"] = pose_error_json(*refined.before);
  if (refined.after) fit["error_after"] = pose_error_json(*refined.after);
  return json;
}

Json novel_views_json(const std::optional<NovelViewMetrics>& means) {
  if (!means) return nullptr;
  Json json = {{"lpips_note", means->lpips_note},
               {"pose_refined", nullptr},
               {"exposure_fitted",
                {{"psnr", written(means->psnr_exposure_fitted)},
                 {"protocol", "3x4 affine, fitted on one half of the image and scored on the other"}}}};
  each_novel_view_number(*means, into(json));
  if (means->interpolating) each_view_group_number(*means->interpolating, into(json["interpolating"]));
  if (means->extrapolating) each_view_group_number(*means->extrapolating, into(json["extrapolating"]));
  if (!means->pose_refined) return json;
  each_refined_summary_number(*means->pose_refined, into(json["pose_refined"]));
  json["pose_refined"]["protocol"] = "pose of each test photo fitted to that photo, scene frozen";
  return json;
}

Json protocol_json(const MeshProtocolResult& result) {
  Json json = {{"protocol", protocol_text(result)}};
  each_mesh_number(result, into(json));
  for (const ThresholdScores& finer : result.scores.finer) each_finer_number(finer, into(json));
  if (result.alignment_report.icp) json["icp_rmse_m"] = written(result.alignment_report.icp->rmse_after);
  return json;
}

Json geometry_json(const std::optional<MeshEvaluation>& evaluation) {
  if (!evaluation) return nullptr;
  Json json = protocol_json(evaluation->headline);
  each_surface_number(evaluation->surface, into(json["surface"]));
  json["variants"] = Json::array();
  for (const MeshProtocolResult& variant : evaluation->variants) json["variants"].push_back(protocol_json(variant));
  return json;
}

Json training_json(const TrainingMetrics& train) {
  Json json = {{"device", train.device}};
  each_training_number(train, into(json));
  return json;
}

}  // namespace

Json metrics_json(const RunMetrics& metrics) {
  Json views = Json::array();
  for (const TestViewMetrics& view : metrics.views) views.push_back(view_json(view));
  return {{"schema", 1},
          {"scene_source", metrics.scene_source},
          {"priors", metrics.priors},
          {"width", metrics.width},
          {"height", metrics.height},
          {"nvs", novel_views_json(metrics.novel_views)},
          {"geometry", geometry_json(metrics.geometry)},
          {"semantics", all_semantics_json(metrics)},
          {"train", training_json(metrics.train)},
          {"per_view", views}};
}

}  // namespace aligngs
