#include "priors/scene_by_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "nn/preprocess/pillow_resize.h"
#include "nn/weights.h"
#include "priors/camera_teacher.h"
#include "priors/teacher_list.h"
#include "priors/test_photos.h"
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

}  // namespace

void scene_by_network(const std::vector<Photo>& photos, const fs::path& scene, const ModelStore& store,
                      const ScenePhotosOptions& options, ThreadPool& pool, ScenePhotosReport& report) {
  if (!photos.empty()) require_training_photos(photos.front().file.parent_path(), photos.size(), options.test_every);
  const PublishedModel& model = published_model(options.model);
  const nn::Weights weights = nn::Weights::open(store.require(model).at(0));
  const Teacher* const teacher = find_camera_teacher(options.model);
  if (!teacher) throw_usage(options.model + " finds no cameras", "see `aligngs poses --help` for the weights");
  PredictedViews predicted = teacher->cameras.family->find_views(photos, weights, *teacher, store, options, pool);
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
    parts.description.units_estimate = {kMetricModel, metres->spread, int(metres->photos)};
    report.metres = metres;
    log_info("metres are an estimate of {}: {:.4f} m per unit of the cameras, {} photos spread by {:.1f} %",
             kMetricModel, metres->scale, metres->photos, 100 * metres->spread);
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
