#include "priors/camera_teacher.h"

#include <utility>

#include "core/log.h"
#include "core/memory_budget.h"
#include "priors/da3_prediction.h"
#include "priors/teacher_list.h"
#include "priors/vggt_prediction.h"

namespace aligngs {
namespace {

void require_memory(const MemoryBudget& budget, const char* network, size_t photos) {
  log_info("memory for {} on {} photos:\n{}", network, photos, budget.table());
  budget.require(network, "use fewer photos, or --method colmap");
}

PredictedViews views_by_vggt(const std::vector<Photo>& photos, const nn::Weights& weights, const Teacher& teacher,
                             const ModelStore&, const ScenePhotosOptions& options, ThreadPool& pool) {
  VggtInputs inputs = vggt_inputs(photos, pool);
  MemoryBudget budget(options.memory_limit);
  add_vggt_memory(budget, weights, options.precision, photos.size(), inputs.images[0].width, inputs.images[0].height);
  require_memory(budget, "VGGT", photos.size());
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const nn::Vggt network(compute, weights);
  return {predict_vggt_views(compute, network, photos, std::move(inputs),
                             {options.shared_focal, options.progress, teacher.cameras.camera_to_world}),
          std::nullopt};
}

/// The network that tells metres; null where none is wanted or installed. Reports the second.
const PublishedModel* metric_model(const ModelStore& store, const ScenePhotosOptions& options) {
  if (options.metres == MetresChoice::kNone) return nullptr;
  const PublishedModel& model = published_model(kMetricModel);
  if (options.metres == MetresChoice::kNetwork) store.require(model);
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

PredictedViews views_by_da3(const std::vector<Photo>& photos, const nn::Weights& weights, const Teacher&,
                            const ModelStore& store, const ScenePhotosOptions& options, ThreadPool& pool) {
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

const CameraFamily kVggtCameras = {PosesMethod::kVggt, views_by_vggt};
const CameraFamily kDa3Cameras = {PosesMethod::kDa3, views_by_da3};

}  // namespace aligngs
