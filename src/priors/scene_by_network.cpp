#include "priors/scene_by_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "core/memory_budget.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "nn/preprocess/pillow_resize.h"
#include "nn/weights.h"
#include "priors/da3_prediction.h"
#include "priors/vggt_prediction.h"
#include "scene/depth_cloud.h"
#include "scene/photo_mask.h"
#include "scene/scene_writer.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Depth of low confidence is no value, for the cloud and as a prior.
void drop_unsure_depth(std::vector<PredictedView>& views, double percent) {
  if (percent <= 0) return;
  const float least = confidence_at(views, percent);
  for (PredictedView& view : views) {
    for (size_t i = 0; i < view.depth.data.size(); ++i) {
      if (!(view.confidence.data[i] >= least)) view.depth.data[i] = 0;
    }
  }
}

/// Depth of pixels that a mask leaves out is no value.
void drop_masked_depth(std::vector<PredictedView>& views, const std::vector<Photo>& photos) {
  for (size_t i = 0; i < views.size(); ++i) {
    const fs::path file = find_mask(photos[i].file);
    if (file.empty()) continue;
    ImageF& depth = views[i].depth;
    const Image<uint8_t> mask = read_mask(file, photos[i].file, true, depth.width, depth.height);
    for (size_t k = 0; k < mask.data.size(); ++k) {
      if (mask.data[k] == 0) depth.data[k] = 0;
    }
  }
}

PointCloud cloud_of(const std::vector<PredictedView>& views, const std::vector<Photo>& photos, size_t max_points,
                    ThreadPool& pool) {
  // Confidence has no upper limit: relative to what the better half of the pixels reach.
  const float reference = std::max(confidence_at(views, 75), 1e-6f);
  std::vector<ImageF> colors(views.size()), weights(views.size());
  std::vector<DepthCloudView> cloud_views;
  pool.parallel_for(views.size(), 1, [&](size_t i, size_t, int) {
    const PredictedView& view = views[i];
    Image<uint8_t> bytes = nn::pillow_rgb_on_white(read_image(photos[i].file));
    colors[i] = resize_area(to_float(bytes), view.depth.width, view.depth.height);
    weights[i] = ImageF(view.depth.width, view.depth.height, 1);
    for (size_t k = 0; k < weights[i].data.size(); ++k)
      weights[i].data[k] = std::clamp(view.confidence.data[k] / reference, 0.f, 1.f);
  });
  for (size_t i = 0; i < views.size(); ++i) {
    const PredictedView& view = views[i];
    cloud_views.push_back(
        {view.camera.resized(view.depth.width, view.depth.height), &view.depth, &colors[i], &weights[i]});
  }
  DepthCloudOptions options;
  options.min_confidence = 0;  // what is unsure is left out already
  options.max_points = max_points;
  return fuse_depth_cloud(cloud_views, options, pool).cloud;
}

void require_memory(const MemoryBudget& budget, const char* network, size_t photos) {
  log_info("memory for {} on {} photos:\n{}", network, photos, budget.table());
  budget.require(network, "use fewer photos, or --method colmap");
}

std::vector<PredictedView> views_by_vggt(const std::vector<Photo>& photos, const nn::Weights& weights,
                                         const ScenePhotosOptions& options, ThreadPool& pool) {
  VggtInputs inputs = vggt_inputs(photos, pool);
  MemoryBudget budget(options.memory_limit);
  add_vggt_memory(budget, weights, options.precision, photos.size(), inputs.images[0].width, inputs.images[0].height);
  require_memory(budget, "VGGT", photos.size());
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const nn::Vggt network(compute, weights);
  const bool camera_to_world = options.model == "lingbot-map";
  return predict_vggt_views(compute, network, photos, std::move(inputs),
                            {options.shared_focal, options.progress, camera_to_world});
}

/// The network that tells metres; null where none is wanted or installed. Reports the second.
const PublishedModel* metric_model(const ModelStore& store, const ScenePhotosOptions& options) {
  if (options.metric_model.empty()) return nullptr;
  const PublishedModel& model = published_model(options.metric_model);
  if (options.metric_model_needed) store.require(model);
  if (store.installed(model)) return &model;
  log_info("units are arbitrary: metres need one more network (aligngs models download {}, {})", model.name,
           format_bytes(download_bytes(model)));
  return nullptr;
}

/// Before the other network is loaded, so that the two never lie in memory together.
void add_metres(nn::Compute& compute, const nn::Weights& weights, Da3Inputs& inputs,
                const ScenePhotosOptions& options) {
  MemoryBudget budget(options.memory_limit);
  add_da3_metric_memory(budget, weights, options.precision, inputs.images.size(), inputs.images[0].width,
                        inputs.images[0].height);
  require_memory(budget, "the metric network", inputs.images.size());
  add_metric_depth(compute, nn::Da3Metric(compute, weights), inputs, options.progress);
}

Da3Views views_by_da3(const std::vector<Photo>& photos, const nn::Weights& weights, const ModelStore& store,
                      const ScenePhotosOptions& options, ThreadPool& pool) {
  const PublishedModel* const metric = metric_model(store, options);
  Da3Inputs inputs = da3_inputs(photos, pool);
  MemoryBudget budget(options.memory_limit);
  add_da3_memory(budget, weights, options.precision, photos.size(), inputs.images[0].width, inputs.images[0].height);
  require_memory(budget, "Depth Anything 3", photos.size());
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  if (metric) add_metres(compute, nn::Weights::open(store.require(*metric).at(0)), inputs, options);
  const nn::Da3 network(compute, weights);
  return predict_da3_views(compute, network, photos, std::move(inputs),
                           {options.shared_focal, options.progress, false, options.camera_from_rays});
}

}  // namespace

void scene_by_network(const std::vector<Photo>& photos, const fs::path& scene, const ModelStore& store,
                      const ScenePhotosOptions& options, ThreadPool& pool, ScenePhotosReport& report) {
  const PublishedModel& model = published_model(options.model);
  const nn::Weights weights = nn::Weights::open(store.require(model).at(0));
  Da3Views predicted;
  if (options.method == PosesMethod::kDa3)
    predicted = views_by_da3(photos, weights, store, options, pool);
  else
    predicted.views = views_by_vggt(photos, weights, options, pool);
  std::vector<PredictedView>& views = predicted.views;
  drop_unsure_depth(views, options.drop_percent);
  drop_masked_depth(views, photos);

  SceneWriter writer(scene, options.overwrite);
  SceneParts parts;
  parts.split.train.emplace();
  parts.split.test.emplace();
  for (size_t i = 0; i < views.size(); ++i) {
    SceneViewParts view;
    view.name = photos[i].name;
    view.camera = views[i].camera;
    view.image_file = photos[i].file;
    view.mask_file = find_mask(photos[i].file);
    view.prior_depth = views[i].depth;
    view.prior_confidence = views[i].confidence;
    view.half_depth = true;
    writer.add_view(view);
    (is_test_photo(i, options.test_every) ? *parts.split.test : *parts.split.train).push_back(view.name);
  }
  parts.cloud = cloud_of(views, photos, options.max_points, pool);
  if (parts.cloud.size() == 0) {
    throw Error({ErrorKind::kFailed, "no point is left of the network's depth", scene, "",
                 "use a lower --drop-percent, or --method colmap"});
  }
  parts.description.source = "photos, cameras and depth by " + model.name;
  if (const auto& metres = predicted.metres) {
    parts.description.metric = true;
    parts.description.units_estimate = {options.metric_model, metres->spread, int(metres->photos)};
    report.metres = metres;
    log_info("metres are an estimate of {}: {:.4f} m per unit of the cameras, {} photos spread by {:.1f} %",
             options.metric_model, metres->scale, metres->photos, 100 * metres->spread);
  }
  const LocatedModelFile located = *store.find(model, model.files[0]);
  parts.priors.depth = PriorJson{model.name,
                                 store.digest(model, model.files[0], located),
                                 {{"drop_percent", fmt::format("{:g}", options.drop_percent)},
                                  {"shared_focal", options.shared_focal ? "yes" : "no"},
                                  {"confidence", "pred_confidence/"}}};
  parts.priors.depth_scale = DepthScale::kScene;  // the cameras are those of the same pass
  writer.finish(parts);
  report.placed = views.size();
  report.points = parts.cloud.size();
  report.train = parts.split.train->size();
  report.test = parts.split.test->size();
}

}  // namespace aligngs
