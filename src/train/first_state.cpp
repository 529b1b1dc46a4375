#include "train/first_state.h"

#include <algorithm>
#include <utility>

#include "core/log.h"
#include "gaussians/morton_order.h"
#include "scene/view_data.h"
#include "train/memory_fit.h"
#include "train/random_purpose.h"
#include "train/start_model.h"

namespace aligngs {

FirstState first_state(const FirstStateInputs& in, const Engine& engine, MemoryBudget& budget, ThreadPool& pool) {
  const TrainConfig& config = in.config;
  const Scene& scene = in.scene.scene;
  const int channels = in.scene.use.semantics ? scene.labels.size() : 0;
  size_t pixels = 0, all_pixels = 0;  // of the largest view, of all
  for (const TrainingView& view : in.views) {
    const size_t size = size_t(view.data.camera.width) * static_cast<size_t>(view.data.camera.height);
    pixels = std::max(pixels, size);
    all_pixels += size;
  }
  const int64_t limit = start_limit(config, pixels);
  const StartInputs inputs{config,   in.views, in.depth_scales, scene.cloud, in.scene.use.depth,
                           channels, limit,    in.scene.extent, pool,        is_sensor_depth(scene.prior_source)};
  StartModel begun =
      make_start_model(inputs, random_of(static_cast<uint64_t>(config.train.seed), RandomPurpose::kStart));
  if (config.densify.morton_order) sort_by_morton(begun.model);
  log_info("{} Gaussians to start with, from {}", begun.model.size(), begun.dense ? "prior depth" : "points");
  FirstState out;
  out.state.depth_scales = in.depth_scales;
  out.state.facts.dense_start = begun.dense;
  out.state.facts.normals_at_start = begun.has_normals;
  out.state.engine.model = std::move(begun.model);
  GaussianCap cap = fit_to_engine({config, out.state.engine.model.size(), begun.dense, limit, all_pixels},
                                  {engine, in.views, channels, pixels}, budget);
  out.warning = std::move(cap.warning);
  out.state.facts.max_gaussians = cap.gaussians;
  return out;
}

}  // namespace aligngs
