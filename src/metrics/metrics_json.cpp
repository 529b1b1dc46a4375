#include "metrics/metrics_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/median.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// The finite values by the names of their classes.
Json by_class(const std::vector<double>& values, const LabelSet& labels) {
  Json json = Json::object();
  for (int c = 0; c < labels.size(); ++c) {
    if (std::isfinite(values[size_t(c)])) json[labels.classes[size_t(c)].name] = values[size_t(c)];
  }
  return json;
}

Json semantic_json(const SemanticScores& scores, const LabelSet& labels) {
  return {
      {"miou", number(scores.miou)},
      {"accuracy", number(scores.accuracy)},
      {"classes", scores.classes},
      {"samples", scores.samples},
      {"rule",
       fmt::format(
           "mean over the classes with at least {:g} % of the labelled samples; present: over all classes of the truth",
           100 * kLeastClassShare)},
      {"iou", by_class(scores.iou, labels)},
      {"present",
       {{"miou", number(scores.present_miou)},
        {"classes", scores.present_classes},
        {"iou", by_class(scores.present_iou, labels)}}}};
}

Json mesh_label_json(const MeshLabelScores& scores, const LabelSet& labels) {
  Json json = semantic_json(scores.all, labels);
  json["coverage"] = number(scores.coverage);
  json["covered_miou"] = number(scores.covered.miou);
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

Json pose_error_json(const PoseError& error) { return {{"metres", error.metres}, {"degrees", error.degrees}}; }

Json view_json(const TestViewMetrics& view) {
  Json json = {{"name", view.name},
               {"psnr", number(view.psnr)},
               {"ssim", number(view.ssim)},
               {"lpips", number(view.lpips)},
               {"lpips_unit", number(view.lpips_unit)},
               {"psnr_exposure_fitted", number(view.psnr_exposure_fitted)},
               {"label_accuracy", number(view.label_accuracy)},
               {"extrapolates", view.extrapolates}};
  if (!view.pose_refined) return json;
  const RefinedPoseMetrics& refined = *view.pose_refined;
  json["pose_refined"] = {{"psnr", number(refined.psnr)},
                          {"ssim", number(refined.ssim)},
                          {"shift", refined.shift},
                          {"turn_degrees", refined.turn_degrees}};
  if (refined.before) json["pose_refined"]["error_before"] = pose_error_json(*refined.before);
  if (refined.after) json["pose_refined"]["error_after"] = pose_error_json(*refined.after);
  return json;
}

/// Over the test views: scores with fitted poses, and the median distance of the poses from the true ones before and
/// after. Null where no pose was fitted.
Json refined_pose_json(const std::vector<TestViewMetrics>& views) {
  const auto median = [&](std::optional<PoseError> RefinedPoseMetrics::*when) {
    std::vector<double> values;
    for (const TestViewMetrics& view : views) {
      if (view.pose_refined && (*view.pose_refined.*when)) values.push_back((*view.pose_refined.*when)->metres);
    }
    return values.empty() ? Json(nullptr) : Json(median_of(std::move(values)));
  };
  if (std::none_of(views.begin(), views.end(), [](const auto& view) { return view.pose_refined.has_value(); }))
    return nullptr;
  return {{"psnr", number(mean_over_views(views, &RefinedPoseMetrics::psnr))},
          {"ssim", number(mean_over_views(views, &RefinedPoseMetrics::ssim))},
          {"median_error_before_m", median(&RefinedPoseMetrics::before)},
          {"median_error_after_m", median(&RefinedPoseMetrics::after)},
          {"protocol", "pose of each test photo fitted to that photo, scene frozen"}};
}

Json novel_views_json(const RunMetrics& m) {
  if (!m.views_measured) return nullptr;
  const auto mean = [&](double TestViewMetrics::*figure, std::optional<bool> extrapolating = {}) {
    return number(mean_over_views(m.views, figure, extrapolating));
  };
  Json json = {{"psnr", mean(&TestViewMetrics::psnr)},
               {"ssim", mean(&TestViewMetrics::ssim)},
               {"lpips", mean(&TestViewMetrics::lpips)},
               {"lpips_unit", mean(&TestViewMetrics::lpips_unit)},
               {"lpips_note", m.lpips_note},
               {"views", m.views.size()},
               {"pose_refined", refined_pose_json(m.views)},
               {"exposure_fitted",
                {{"psnr", mean(&TestViewMetrics::psnr_exposure_fitted)},
                 {"protocol", "3x4 affine, fitted on one half of the image and scored on the other"}}}};
  for (const bool extrapolating : {false, true}) {
    json[extrapolating ? "extrapolating" : "interpolating"] = {
        {"psnr", mean(&TestViewMetrics::psnr, extrapolating)},
        {"ssim", mean(&TestViewMetrics::ssim, extrapolating)},
        {"views", std::count_if(m.views.begin(), m.views.end(),
                                [&](const TestViewMetrics& view) { return view.extrapolates == extrapolating; })}};
  }
  return json;
}

Json protocol_json(const MeshProtocolResult& result) {
  const MeshScores& s = result.scores;
  Json json = {{"protocol", protocol_text(result)},
               {"accuracy", number(s.accuracy)},
               {"completeness", number(s.completeness)},
               {"precision", number(s.precision)},
               {"recall", number(s.recall)},
               {"fscore", number(s.fscore)},
               {"threshold_m", s.threshold},
               {"camera_rmse_m", number(result.alignment_report.camera_rmse)},
               {"truth_area_m2", number(result.truth_area)}};
  for (const ThresholdScores& finer : s.finer) {
    const std::string suffix = fmt::format("_{:.0f}cm", 100 * finer.threshold);
    json["precision" + suffix] = number(finer.precision);
    json["recall" + suffix] = number(finer.recall);
    json["fscore" + suffix] = number(finer.fscore);
  }
  if (result.alignment_report.icp) json["icp_rmse_m"] = number(result.alignment_report.icp->rmse_after);
  return json;
}

/// Angles in degrees, pinholes as shares (metrics/surface_quality.h).
Json surface_json(const SurfaceQuality& s) {
  return {{"normal_error_mean_deg", number(s.normal_error.mean)},
          {"normal_error_median_deg", number(s.normal_error.median)},
          {"structure_normal_error_mean_deg", number(s.structure_normal_error.mean)},
          {"structure_normal_error_median_deg", number(s.structure_normal_error.median)},
          {"roughness_mean_deg", number(s.roughness.mean)},
          {"roughness_median_deg", number(s.roughness.median)},
          {"pinholes", number(s.pinholes)},
          {"structure_pinholes", number(s.structure_pinholes)},
          {"truth_seen_m2", number(s.truth_seen)}};
}

Json geometry_json(const std::optional<MeshEvaluation>& evaluation) {
  if (!evaluation) return nullptr;
  Json json = protocol_json(evaluation->headline);
  json["surface"] = surface_json(evaluation->surface);
  json["variants"] = Json::array();
  for (const MeshProtocolResult& variant : evaluation->variants) json["variants"].push_back(protocol_json(variant));
  return json;
}

Json training_json(const TrainingMetrics& train) {
  return {{"seconds", number(train.seconds)},
          {"iterations", train.iterations},
          {"gaussians", train.gaussians},
          {"iterations_per_second", number(train.iterations_per_second)},
          {"peak_memory_bytes", train.peak_memory_bytes ? Json(*train.peak_memory_bytes) : Json(nullptr)},
          {"device", train.device}};
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
          {"nvs", novel_views_json(metrics)},
          {"geometry", geometry_json(metrics.geometry)},
          {"semantics", all_semantics_json(metrics)},
          {"train", training_json(metrics.train)},
          {"per_view", views}};
}

}  // namespace aligngs
