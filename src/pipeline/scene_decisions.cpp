#include "pipeline/scene_decisions.h"

#include <fmt/format.h>

#include "core/progress.h"
#include "refine/refined_scene.h"
#include "train/training_set.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

Decision yes(std::string reason) { return {.wanted = true, .reason = std::move(reason)}; }
Decision no(std::string reason, Notice notice = Notice::kNone) {
  return {.reason = std::move(reason), .notice = notice};
}

Decision by_network(const PublishedModel& model, std::string reason) {
  return {.wanted = true, .reason = std::move(reason), .network = &model};
}

/// Metric prior depth is of use to training.
bool wants_metric_depth(const TrainConfig& config) {
  return config.data.prior_depth == PriorDepthUse::kAuto || config.data.prior_depth == PriorDepthUse::kMetric;
}

}  // namespace

Decision decide_depth(bool measurable, const PriorRequest& priors, const CameraRequest& cameras,
                      const ModelStore& store) {
  if (priors.depth.none()) return no("--depth none leaves depth of networks out");
  if (const Teacher* const named = priors.depth.network) {
    const PublishedModel& model = published_model(named->model);
    return by_network(model, fmt::format("no prior depth: depth by {}, as --depth asks", model.name));
  }
  Decision decision;
  if (const PublishedModel* const model = installed_camera_network(cameras, store))
    decision = by_network(*model, fmt::format("no prior depth: depth by {}, the network for cameras", model->name));
  else if (measurable)
    return no("depth is measured in the photos, and no network for cameras is installed");
  else if (const PublishedModel* const other = installed_depth_model(store))
    decision = by_network(*other, fmt::format("no prior depth: depth by {}, the first that is installed", other->name));
  else
    return no("no network for depth is installed");
  const bool named = !cameras.model.empty() || is_camera_network_method(cameras.method);
  if (!named) decision.terms = terms_of_choice(*decision.network, "depth");
  return decision;
}

Decision decide_depth(const Scene& scene, const PriorRequest& priors, const CameraRequest& cameras,
                      const TrainConfig& config, const ModelStore& store) {
  if (scene.has_prior_depth()) return no("the scene has prior depth");
  return decide_depth(decide_measure(scene, config).wanted, priors, cameras, store);
}

Decision decide_classes(const PriorRequest& priors, const ModelStore& store) {
  if (priors.semantics.none()) return no("--semantics none leaves classes out");
  if (const Teacher* const named = priors.semantics.network) {
    const PublishedModel& model = published_model(named->model);
    return by_network(model, fmt::format("no class labels: labels by {}, as --semantics asks", model.name));
  }
  if (const PublishedModel* const model = installed_semantic_model(store))
    return by_network(*model, fmt::format("no class labels: labels by {}, the first that is installed", model->name));
  std::string remedy;
  for (const PublishedModel* model : suggested_semantic_models()) {
    remedy += fmt::format("{}{}, {}", remedy.empty() ? "aligngs models download " : ", or ", model->name,
                          format_bytes(download_bytes(*model)));
  }
  return no(fmt::format("no class labels: no weights for them are here ({})", remedy), Notice::kInfo);
}

Decision decide_classes(const Scene& scene, const PriorRequest& priors, const ModelStore& store) {
  if (scene.has_semantics()) return no("the scene has class labels");
  return decide_classes(priors, store);
}

Decision may_measure(const TrainConfig& config) {
  if (!config.data.measure_depth) return no("the settings leave it out (data.measure_depth)");
  if (!wants_metric_depth(config)) return no("the settings use no such depth (data.prior_depth)");
  return yes("points without prior depth: depth is measured in the photos");
}

Decision decide_measure(const Scene& scene, const TrainConfig& config) {
  Decision decision = may_measure(config);
  if (!decision.wanted) return decision;
  if (scene.has_prior_depth()) return no("the scene has prior depth");
  if (scene.cloud.size() == 0) return no("the scene has no points to begin with");
  return decision;
}

Decision may_refine(const TrainConfig& config) {
  if (!config.data.refine_cameras) return no("the settings leave it out (data.refine_cameras)");
  return yes("cameras and prior depth are corrected from the photos");
}

Decision decide_refine(const Scene& scene, const TrainConfig& config) {
  const Decision allowed = may_refine(config);
  if (!config.data.refine_cameras) return allowed;
  if (is_refined_scene(scene.folder)) return no("the scene is refined already");
  if (scene.prior_source == kStereoDepth) return no("depth was measured with these very cameras");
  if (is_sensor_depth(scene.prior_source)) {
    return no("cameras that come with a sensor's depth are checked, and corrected where that helps");
  }
  const PriorUse use = decide_prior_use(scene, config);
  if (use.depth != PriorDepthKind::kMetric || use.placement.placed() < use.placement.views.size()) {
    return no(fmt::format("cameras stay unrefined: the search for matches needs prior depth in the units of the scene "
                          "({})",
                          use.depth_note),
              Notice::kInfo);
  }
  return allowed;
}

namespace {

/// Work on the depth of a sensor, or on given depth.
bool completes_any_depth(const TrainConfig& config) {
  return (config.data.exposure && config.data.sensor_exposure) || config.data.fill_depth;
}

Decision completion_left_out() {
  return no("the settings leave it out (data.sensor_exposure, data.sensor_cameras, data.clean_depth, data.fill_depth)");
}

}  // namespace

Decision may_complete(const TrainConfig& config) {
  if (!completes_any_depth(config) && !config.data.sensor_cameras && !config.data.clean_depth)
    return completion_left_out();
  if (!wants_metric_depth(config)) return no("the settings use no such depth (data.prior_depth)");
  return yes("depth of a sensor, or given depth: cameras are checked, exposures are measured, and holes are filled");
}

Decision decide_complete(const Scene& scene, const TrainConfig& config) {
  Decision decision = may_complete(config);
  if (!decision.wanted) return decision;
  if (!scene.has_prior_depth()) return no("the scene has no prior depth");
  if (scene.has_network_depth() || scene.prior_source == kStereoDepth || scene.depth_scale != DepthScale::kScene)
    return no("the depth is neither of a sensor nor given");
  if (fs::exists(scene.folder / "exposure.json") || is_refined_scene(scene.folder))
    return no("the scene has that already");
  if (!is_sensor_depth(scene.prior_source) && !completes_any_depth(config)) return completion_left_out();
  return decision;
}

}  // namespace aligngs
