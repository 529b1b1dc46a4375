#include "cli/stages/eval_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "cli/report/json_field.h"
#include "cli/stages/perceptual_metric.h"
#include "core/error.h"
#include "core/log.h"
#include "core/median.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "metrics/image_metrics.h"
#include "metrics/mesh_protocols.h"
#include "metrics/semantic_metrics.h"
#include "metrics/view_novelty.h"
#include "refine/photo_alignment.h"
#include "scene/mesh_ply.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr double kMetresPerExtent = 3;  // extent of a room of 4 to 5 m, for scenes without metres

/// NaN and infinity have no JSON form: null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Mean of the finite values of one key over the views, or over those that extrapolate or do not; null without any.
Json mean_of(const Json& views, const char* key, std::optional<bool> extrapolating = {}) {
  double sum = 0;
  int count = 0;
  for (const Json& view : views) {
    if (!view.contains(key) || !view[key].is_number()) continue;
    if (extrapolating && view.value("extrapolates", false) != *extrapolating) continue;
    sum += view[key].get<double>();
    ++count;
  }
  return count ? Json(sum / count) : Json(nullptr);
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

struct ViewMetrics {
  Json per_view = Json::array();
  Json nvs, semantics = nullptr;
};

/// True cameras decide where the photos were taken, if there are any.
std::vector<Camera> true_training_cameras(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const int view : scene.train) cameras.push_back(scene.evaluation_cameras[static_cast<size_t>(view)]);
  return cameras;
}

/// The cameras of the run and the true ones, without meshes yet.
MeshEvaluationInput evaluation_cameras_of(const Scene& scene) {
  MeshEvaluationInput input;
  for (const View& view : scene.views) input.run_cameras.push_back(view.camera);
  input.truth_cameras = scene.evaluation_cameras;
  input.train = scene.train;
  return input;
}

/// How far a pose is from the true one: metres and degrees.
Json pose_error(const Camera& camera, const Camera& truth, const Similarity& to_truth) {
  const Rigidd moved = to_truth.transform_world_to_camera(camera.world_to_camera);
  return {{"metres", norm(to_truth * camera.centre() - truth.centre())},
          {"degrees", rotation_angle_between_degrees(moved.rotation, truth.world_to_camera.rotation)}};
}

/// Gain of the picture with the pose fitted to the test photo itself; the scene is frozen.
void measure_with_refined_pose(OpenRun& run, int view, const ViewData& data, const Similarity& to_truth, Json& entry) {
  RenderOptions options = run.render_options();
  options.labels = false;
  const LookAtScene look = [&](const Camera& camera) {
    Rendering r = run.engine->render(camera, options);
    run.expose_as(view, r.color);
    return SceneLook{std::move(r.color), std::move(r.depth_plane)};
  };
  const PhotoAlignment aligned = align_to_photo(data.camera, data.color, data.mask, look);
  const ImageScores scores = compare_images(look(aligned.camera).color, data.color, data.mask, {}, run.pool.get());
  entry["pose_refined"] = {{"psnr", number(scores.psnr)},
                           {"ssim", number(scores.ssim)},
                           {"shift", norm(aligned.camera.centre() - data.camera.centre())},
                           {"turn_degrees", rotation_angle_between_degrees(aligned.camera.world_to_camera.rotation,
                                                                           data.camera.world_to_camera.rotation)}};
  const std::optional<Camera>& truth = run.scene.views[static_cast<size_t>(view)].truth_camera;
  if (!truth) return;
  entry["pose_refined"]["error_before"] = pose_error(data.camera, *truth, to_truth);
  entry["pose_refined"]["error_after"] = pose_error(aligned.camera, *truth, to_truth);
}

/// Over the test views: scores with fitted poses, and the median distance of the poses from the true ones before and
/// after.
Json refined_pose_json(const Json& per_view) {
  Json refined = Json::array();
  for (const Json& view : per_view) refined.push_back(view["pose_refined"]);
  const auto median = [&](const char* when) {
    std::vector<double> values;
    for (const Json& view : refined) {
      if (view.contains(when)) values.push_back(view[when]["metres"].get<double>());
    }
    return values.empty() ? Json(nullptr) : Json(median_of(std::move(values)));
  };
  return {{"psnr", mean_of(refined, "psnr")},
          {"ssim", mean_of(refined, "ssim")},
          {"median_error_before_m", median("error_before")},
          {"median_error_after_m", median("error_after")},
          {"protocol", "pose of each test photo fitted to that photo, scene frozen"}};
}

ViewMetrics measure_views(OpenRun& run, const EvalStageOptions& options) {
  ViewMetrics result;
  ConfusionMatrix confusion(run.scene.labels.size()), taught(run.scene.labels.size());
  bool labelled = false, judged = false;
  const std::vector<Camera> training = true_training_cameras(run.scene);
  const double metres_per_unit = run.scene.metric ? 1 : kMetresPerExtent / robust_extent(run.scene);
  const PerceptualMetric perceptual(ModelStore(ModelStoreOptions::from_environment(true)), *run.pool);
  Progress progress(options.progress, "evaluate views", run.scene.test.size());
  LoadOptions load = run.load_options();
  load.scores_as_logits = run.config.data.scores_as_logits;
  // the teacher is judged by its best class of every pixel, whatever the run itself makes of its scores
  load.least_score_sum = 0;
  const Similarity to_truth = align_on_training_cameras(evaluation_cameras_of(run.scene)).similarity;
  for (const int index : run.scene.test) {
    const View& view = run.scene.views[index];
    const bool labels = run.has_labels() && !view.truth_labels.empty();
    load.semantics = labels;  // the teacher's own, to be judged beside the rendered ones
    const ViewData data = load_view(run.scene, index, load);
    Rendering rendering = run.engine->render(data.camera, run.render_options());
    run.expose_as(index, rendering.color);
    const ImageScores scores = compare_images(rendering.color, data.color, data.mask, {}, run.pool.get());
    Json entry = {{"name", view.name},           {"psnr", number(scores.psnr)},
                  {"ssim", number(scores.ssim)}, {"lpips", nullptr},
                  {"lpips_unit", nullptr},       {"psnr_exposure_fitted", number(scores.psnr_affine_crossfit)},
                  {"label_accuracy", nullptr}};
    const ViewNovelty novelty = view_novelty(run.scene.evaluation_cameras[static_cast<size_t>(index)], training);
    entry["extrapolates"] = extrapolates(novelty, metres_per_unit);
    if (const auto distances = perceptual.measure(rendering.color, data.color, data.mask)) {
      entry["lpips"] = number(distances->canonical);
      entry["lpips_unit"] = number(distances->unit);
    }
    if (labels) {
      const Image<uint16_t> truth = load_truth_labels(run.scene, index, data.camera);
      confusion.add(truth, rendering.label);
      ConfusionMatrix own(run.scene.labels.size());
      own.add(truth, rendering.label);
      entry["label_accuracy"] = number(own.scores().accuracy);
      labelled = true;
      if (!data.labels.empty()) taught.add(truth, data.labels);
      judged |= !data.labels.empty();
    }
    if (options.refine_test_poses) measure_with_refined_pose(run, index, data, to_truth, entry);
    result.per_view.push_back(std::move(entry));
    progress.update(result.per_view.size());
  }
  result.nvs = {{"psnr", mean_of(result.per_view, "psnr")},
                {"ssim", mean_of(result.per_view, "ssim")},
                {"lpips", mean_of(result.per_view, "lpips")},
                {"lpips_unit", mean_of(result.per_view, "lpips_unit")},
                {"lpips_note", perceptual.reason().empty()
                                   ? Json("VGG16, v0.1; lpips: inputs in [-1, 1], lpips_unit: inputs left in [0, 1]")
                                   : Json(perceptual.reason())},
                {"views", result.per_view.size()},
                {"pose_refined", nullptr},
                {"exposure_fitted",
                 {{"psnr", mean_of(result.per_view, "psnr_exposure_fitted")},
                  {"protocol", "3x4 affine, fitted on one half of the image and scored on the other"}}}};
  if (options.refine_test_poses && !result.per_view.empty())
    result.nvs["pose_refined"] = refined_pose_json(result.per_view);
  for (const bool extrapolating : {false, true}) {
    result.nvs[extrapolating ? "extrapolating" : "interpolating"] = {
        {"psnr", mean_of(result.per_view, "psnr", extrapolating)},
        {"ssim", mean_of(result.per_view, "ssim", extrapolating)},
        {"views", std::count_if(result.per_view.begin(), result.per_view.end(),
                                [&](const Json& v) { return v["extrapolates"] == extrapolating; })}};
  }
  if (labelled) result.semantics = semantic_json(confusion.scores(), run.scene.labels);
  // The yardstick of the training: the teacher run on the test photos themselves.
  if (judged) result.semantics["teacher"] = semantic_json(taught.scores(), run.scene.labels);
  return result;
}

Json geometry_json(const MeshProtocolResult& result) {
  const MeshScores& s = result.scores;
  Json json = {{"protocol", fmt::format("{}, {}, alignment: {}", result.protocol, result.culling, result.alignment)},
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

/// Per class 1 for those that bound a room.
std::vector<uint8_t> structural_classes(const LabelSet& labels) {
  std::vector<uint8_t> structural(static_cast<size_t>(labels.size()), 0);
  for (const char* name : {"wall", "floor", "ceiling"}) {
    if (const int c = labels.find(name); c >= 0) structural[static_cast<size_t>(c)] = 1;
  }
  return structural;
}

/// Geometry and mesh labels against the true mesh; nulls when either mesh is missing.
void measure_mesh(OpenRun& run, const EvalStageOptions& options, Json& geometry, Json& mesh_semantics) {
  const fs::path truth_file = options.truth_mesh.empty() ? run.scene.truth_mesh : options.truth_mesh;
  const fs::path mesh_file = options.mesh.empty() ? run.folder / "mesh" / "mesh.ply" : options.mesh;
  if (truth_file.empty() || !fs::exists(truth_file)) return;
  if (!fs::exists(mesh_file)) {
    log_warning("{} is missing, so geometry is not measured (run `aligngs mesh` first)", mesh_file.string());
    return;
  }
  const TriangleMesh predicted = read_mesh_ply(mesh_file), truth = read_mesh_ply(truth_file);
  MeshEvaluationInput input = evaluation_cameras_of(run.scene);
  input.predicted = &predicted;
  input.truth = &truth;
  input.structural = structural_classes(run.scene.labels);
  const MeshEvaluation evaluation = evaluate_mesh(input, run.scene.metric, options.icp, *run.pool);
  geometry = geometry_json(evaluation.headline);
  geometry["surface"] = surface_json(evaluation.surface);
  geometry["variants"] = Json::array();
  for (const MeshProtocolResult& variant : evaluation.variants) geometry["variants"].push_back(geometry_json(variant));
  if (predicted.labels.size() == predicted.vertices.size() && truth.labels.size() == truth.vertices.size() &&
      !truth.vertices.empty() && run.has_labels()) {
    const TriangleMesh seen = cull_to_first_hits(truth, input.truth_cameras, *run.pool);
    const TriangleMesh moved = transformed(predicted, evaluation.headline.alignment_report.similarity);
    const MeshLabelScores labels = compare_mesh_labels(moved, seen, run.scene.labels.size(), *run.pool);
    mesh_semantics = semantic_json(labels.all, run.scene.labels);
    mesh_semantics["coverage"] = number(labels.coverage);
    mesh_semantics["covered_miou"] = number(labels.covered.miou);
    mesh_semantics["class_coverage"] = by_class(labels.class_coverage, run.scene.labels);
  }
}

Json training_json(const OpenRun& run) {
  Json train = {{"seconds", nullptr},
                {"iterations", run.config.train.iterations},
                {"gaussians", run.model.size()},
                {"iterations_per_second", nullptr},
                {"peak_memory_bytes", nullptr},
                {"device", run.engine->device_name()}};
  const fs::path file = run.folder / "run.json";
  const Json state = fs::exists(file) ? parse_json(read_file(file)) : Json();
  if (!state.is_object() || !state.contains("train") || !state["train"].is_object()) return train;
  for (const auto& [key, value] : state["train"].items()) train[key] = value;
  return train;
}

}  // namespace

Json evaluate_run(OpenRun& run, const EvalStageOptions& options) {
  ViewMetrics views;
  if (options.views) views = measure_views(run, options);
  Json geometry = nullptr, mesh_semantics = nullptr;
  measure_mesh(run, options, geometry, mesh_semantics);
  Json semantics = views.semantics;
  if (!mesh_semantics.is_null()) {
    if (semantics.is_null()) semantics = {{"miou", nullptr}, {"accuracy", nullptr}, {"present", {{"miou", nullptr}}}};
    semantics["mesh"] = mesh_semantics;
  }
  const Json metrics = {{"schema", 1},
                        {"scene_source", run.scene.source},
                        {"priors", run.scene.prior_source},
                        {"width", run.working_camera(0).width},
                        {"height", run.working_camera(0).height},
                        {"nvs", views.nvs},
                        {"geometry", geometry},
                        {"semantics", semantics},
                        {"train", training_json(run)},
                        {"per_view", views.per_view}};
  if (options.mesh.empty()) write_file_atomically(run.folder / "metrics.json", json_document(metrics));
  return metrics;
}

std::vector<LeastValue> least_values(const std::vector<std::string>& conditions) {
  const std::vector<std::pair<std::string, std::string>> short_names = {
      {"psnr", "nvs.psnr"}, {"ssim", "nvs.ssim"}, {"fscore", "geometry.fscore"}, {"miou", "semantics.miou"}};
  std::vector<LeastValue> values;
  for (const std::string& condition : conditions) {
    const size_t equals = condition.find('=');
    char* end = nullptr;
    const double wanted = equals == std::string::npos ? 0 : std::strtod(condition.c_str() + equals + 1, &end);
    if (equals == std::string::npos || end == condition.c_str() + equals + 1 || *end != '\0' || !std::isfinite(wanted))
      throw_usage("--fail-under needs name=number, got \"" + condition + "\"", "for example --fail-under psnr=24");
    std::string path = condition.substr(0, equals);
    const auto is_short = [&](const auto& name) { return name.first == path; };
    const auto known = std::find_if(short_names.begin(), short_names.end(), is_short);
    if (known != short_names.end()) path = known->second;
    constexpr std::array<std::string_view, 4> kParts = {"nvs", "geometry", "semantics", "train"};
    if (std::find(kParts.begin(), kParts.end(), path.substr(0, path.find('.'))) == kParts.end()) {
      throw_usage("--fail-under: there is no figure \"" + path + "\"",
                  "names are psnr, ssim, fscore, miou, and those of metrics.json, as geometry.recall");
    }
    values.push_back({path, wanted});
  }
  return values;
}

void require_at_least(const Json& metrics, const std::vector<LeastValue>& values) {
  for (const auto& [path, least] : values) {
    const double value = number_at(metrics, path);
    if (std::isnan(value)) {
      throw_usage("--fail-under: this run has no number \"" + path + "\"",
                  "names are those of metrics.json, e.g. nvs.psnr, geometry.fscore");
    }
    if (value < least) {
      throw Error(
          {ErrorKind::kBelow, fmt::format("{} is {:.4g}, below the required {:.4g}", path, value, least), {}, {}, {}});
    }
  }
}

}  // namespace aligngs
