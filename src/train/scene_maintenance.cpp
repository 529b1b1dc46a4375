#include "train/scene_maintenance.h"

#include "train/free_space.h"
#include "train/prior_alignment.h"
#include "train/smallest_scale.h"

namespace aligngs {
namespace {

/// Statistics do not outlive a change of rows: whether they follow their rows is the engine's business.
void apply(Engine& engine, const RestructurePlan& plan) {
  engine.restructure(plan);
  engine.reset_density_statistics();
}

ImageF median_depth(const Engine& engine, const GuideView& view, const RasterSettings& raster) {
  RenderOptions options;
  options.raster = raster;
  options.raster.near_plane = view.near_plane;
  options.median_only = true;
  return std::move(engine.render(view.camera, options).depth_median);
}

}  // namespace

RestructurePlan control_density(Engine& engine, const DensityRule& rule, Random& random) {
  GaussianModel model;
  engine.store_shapes(model);
  const RestructurePlan plan = plan_density_control(model, engine.density_statistics(), rule, random);
  apply(engine, plan);
  return plan;
}

RestructurePlan grow_by_mcmc(Engine& engine, const McmcRule& rule, Random& random) {
  GaussianModel model;
  engine.store_shapes(model);
  const RestructurePlan plan = plan_mcmc_growth(model, rule, random);
  apply(engine, plan);
  return plan;
}

RestructurePlan remove_gaussian(Engine& engine, int64_t row) {
  std::vector<uint8_t> keep(engine.size(), 1);
  if (row >= 0 && static_cast<size_t>(row) < keep.size()) keep[static_cast<size_t>(row)] = 0;
  const RestructurePlan plan = plan_keep(keep);
  apply(engine, plan);
  return plan;
}

RestructurePlan prune_free_space(Engine& engine, const std::vector<GuideView>& views,
                                 const std::vector<float>& depth_scales, const TrainConfig& config, double extent,
                                 const RasterSettings& raster, ThreadPool& pool) {
  std::vector<ImageF> rendered;
  rendered.reserve(views.size());
  std::vector<FreeSpaceView> sources;
  for (size_t v = 0; v < views.size(); ++v) {
    rendered.push_back(median_depth(engine, views[v], raster));
    FreeSpaceView source;
    source.camera = views[v].camera;
    source.prior_depth = views[v].prior_depth.empty() || !(depth_scales[v] > 0) ? nullptr : &views[v].prior_depth;
    source.prior_weight = views[v].depth_weight.empty() ? nullptr : &views[v].depth_weight;
    source.prior_scale = depth_scales[v];
    source.median_depth = &rendered.back();
    sources.push_back(source);
  }
  FreeSpaceRule rule;
  rule.prior_relative = config.densify.free_space_prior;
  rule.prior_offset = config.densify.free_space_offset * extent;
  rule.rendered_relative = config.densify.free_space_rendered;
  rule.agreement = config.densify.free_space_agreement;
  GaussianModel model;
  engine.store_shapes(model);
  const RestructurePlan plan = plan_keep(free_space_keep(model, sources, rule, pool));
  if (plan.pruned > 0) apply(engine, plan);
  return plan;
}

void raise_small_scales(Engine& engine, const std::vector<GuideView>& views, double pixels, ThreadPool& pool) {
  GaussianModel model;
  engine.store_shapes(model);
  engine.raise_scales(smallest_log_scales(model, views, pixels, pool));
}

PriorScales align_to_points(const std::vector<GuideView>& views, const PointCloud& cloud, double limit) {
  PriorAlignmentRule rule;
  rule.limit = limit;
  PriorScales out{std::vector<float>(views.size(), 1.0f), std::vector<uint8_t>(views.size(), 0),
                  std::vector<uint8_t>(views.size(), 0)};
  for (size_t v = 0; v < views.size(); ++v) {
    if (views[v].prior_depth.empty()) continue;
    const std::optional<float> scale =
        align_prior_to_points(views[v].prior_depth, views[v].depth_weight, views[v].camera, cloud, rule);
    if (!scale) continue;
    out.scale[v] = *scale;
    out.known[v] = 1;
  }
  return out;
}

PriorScales scales_of_agreeing_depth(size_t views) {
  return {std::vector<float>(views, 1.0f), std::vector<uint8_t>(views, 1), std::vector<uint8_t>(views, 0)};
}

void free_unplaced(const PriorUse& use, PriorScales& scales) {
  for (size_t v = 0; v < scales.scale.size(); ++v) {
    if (!use.is_unplaced(v)) continue;
    scales.scale[v] = 0;
    scales.known[v] = 0;
    scales.free[v] = 1;
  }
}

void align_to_renderings(const Engine& engine, const std::vector<GuideView>& views, const std::vector<uint8_t>& known,
                         const std::vector<uint8_t>& free, double limit, const RasterSettings& raster,
                         std::vector<float>& depth_scales) {
  PriorAlignmentRule rule;
  rule.limit = limit;
  for (size_t v = 0; v < views.size(); ++v) {
    if (known[v] || views[v].prior_depth.empty()) continue;
    const ImageF rendered = median_depth(engine, views[v], raster);
    const std::optional<float> scale = (v < free.size() && free[v] ? find_prior_scale : align_prior_to_depth)(
        views[v].prior_depth, views[v].depth_weight, rendered, rule);
    if (scale) depth_scales[v] = *scale;
  }
}

}  // namespace aligngs
