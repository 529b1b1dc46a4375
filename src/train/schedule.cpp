#include "train/schedule.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aligngs {
namespace {

constexpr int64_t kRaiseScalesEvery = 100;  // [ref] a scale shrinks by at most a third in so many steps
constexpr int kManyViews = 30;  // SH degree 2 only above it: fewer views do not show what depends on direction

// A step of Adam moves a logit by its rate at most, however short the run is; twice as many steps leave room for turns.
constexpr double kRecoveredOpacity = 0.9;  // of a surface
constexpr double kRecoverySlack = 2;

float to_float(double v) { return static_cast<float>(v); }
double logit(double p) { return std::log(p / (1 - p)); }

}  // namespace

Schedule::Schedule(const TrainConfig& config, const TrainingFacts& facts) : config_(config), facts_(facts) {
  length_ = config.train.schedule_iterations > 0 ? config.train.schedule_iterations : config.train.iterations;
}

int64_t Schedule::scaled(int64_t reference_iterations) const {
  return std::llround(static_cast<double>(reference_iterations) * static_cast<double>(length_) /
                      static_cast<double>(config_.train.reference_iterations));
}

int64_t Schedule::scaled_stop(int64_t reference_iterations) const {
  if (reference_iterations >= config_.train.reference_iterations) return std::numeric_limits<int64_t>::max();
  return scaled(reference_iterations);
}

bool Schedule::every(int64_t iteration, int64_t reference_interval) const {
  if (reference_interval <= 0 || iteration >= config_.train.iterations) return false;
  return iteration % std::max<int64_t>(1, scaled(reference_interval)) == 0;
}

double Schedule::share(int64_t iteration) const {
  return std::min(1.0, static_cast<double>(iteration) / static_cast<double>(length_));
}

StepRequest Schedule::request(int64_t iteration) const {
  StepRequest r;
  r.step = iteration;
  // Colour that depends on the direction hides what is wrong with cameras; where nothing is, it shows gloss.
  const int64_t usual = !facts_.network_cameras ? 3 : facts_.training_views > kManyViews ? 2 : 1;
  const int64_t top = config_.train.sh_degree >= 0 ? config_.train.sh_degree : usual;
  r.sh_degree = static_cast<int>(std::min(top, iteration / std::max<int64_t>(1, scaled(config_.train.sh_every))));
  r.losses = losses(iteration);
  r.rates = rates(iteration);
  r.adam.skip_invisible_semantics = config_.optimizer.skip_invisible_semantics;
  r.limits.flat_ratio_max = to_float(config_.optimizer.flat_ratio_max);
  r.limits.aspect_max = to_float(config_.optimizer.aspect_max);
  r.limits.scale_max = to_float(config_.optimizer.scale_max * facts_.extent);
  r.raster.near_plane = to_float(config_.train.near_plane * facts_.extent);
  r.collect_density = config_.densify.enabled && iteration <= scaled_stop(config_.densify.stop);
  r.extent = facts_.extent;
  return r;
}

LossSettings Schedule::losses(int64_t iteration) const {
  const LossConfig& c = config_.loss;
  const SemanticConfig& s = config_.semantic;
  const bool metric = facts_.prior_depth == PriorDepthKind::kMetric;
  const bool relative = facts_.prior_depth == PriorDepthKind::kRelative;
  const bool normals = iteration > scaled(c.normal_start);
  // Without normals at the start the plane depth is noise until the Gaussians have turned.
  const bool turned = facts_.normals_at_start || normals;
  const auto gate = [](bool open, LossGate bit) { return open ? unsigned(bit) : 0u; };
  const unsigned open =
      gate(facts_.semantics, kGateSemantics) | gate(metric, kGateMetric) |
      gate(relative || (metric && c.log_depth == 0), kGateCorrelated) |
      gate(iteration > scaled(c.depth_start) && turned, kGateDepth) | gate(normals, kGateNormals) |
      gate(iteration > scaled(c.multi_view_from) && iteration % c.multi_view_every == 0 && turned, kGateTwoViews);
  LossSettings l;
  l.weight = scheduled_weights(config_, open, share(iteration));
  const int visit = static_cast<int>((iteration - 1) / std::max(1, facts_.training_views));
  l.semantic_sample = make_semantic_sample(s.pixel_share, visit, facts_.image_side);
  l.semantic_blend = s.blend;
  l.coupling = s.coupling;
  const bool coupled = iteration > scaled(s.coupling_start) && iteration <= scaled_stop(s.coupling_stop);
  l.coupling_strength = coupled ? to_float(s.coupling_strength) : 0;

  l.log_depth_huber = to_float(c.log_depth_huber);
  l.paper_normals = c.paper_normals;
  return l;
}

LearningRates Schedule::rates(int64_t iteration) const {
  const OptimizerConfig& o = config_.optimizer;
  LearningRates r;
  r.position = to_float(log_linear(o.position, o.position_end, share(iteration)) * facts_.extent);
  r.sh_dc = to_float(o.sh_dc);
  r.sh_rest = to_float(o.sh_rest);
  r.opacity = to_float(o.opacity);
  r.scale = to_float(o.scale);
  r.rotation = to_float(o.rotation);
  r.semantic = facts_.semantics ? to_float(o.semantic) : 0;
  return r;
}

PoseRates Schedule::pose_rates(int64_t iteration) const {
  const OptimizerConfig& o = config_.optimizer;
  const int64_t first = scaled(o.pose_start), last = scaled_stop(o.pose_stop);
  if (iteration <= first || iteration > last) return {};
  const double over = static_cast<double>(iteration - first) /
                      static_cast<double>(std::max<int64_t>(1, std::min(last, length_) - first));
  const double left = log_linear(1, o.pose_end, std::min(1.0, over));
  return {o.pose_rotation * left, o.pose_translation * left * facts_.extent, o.pose_decay};
}

bool Schedule::densifies(int64_t iteration) const {
  const DensifyConfig& d = config_.densify;
  if (!d.enabled || iteration >= config_.train.iterations) return false;
  if (iteration <= scaled(d.start) || iteration > scaled_stop(d.stop)) return false;
  const int64_t epochs = static_cast<int64_t>(std::ceil(d.min_epochs * facts_.training_views));
  return iteration % std::max<int64_t>({1, scaled(d.every), epochs}) == 0;
}

int64_t Schedule::opacity_recovery() const {
  if (config_.optimizer.opacity <= 0) return std::numeric_limits<int64_t>::max();
  return std::llround(kRecoverySlack * (logit(kRecoveredOpacity) - logit(kResetOpacity)) / config_.optimizer.opacity);
}

bool Schedule::resets_opacity(int64_t iteration) const {
  const DensifyConfig& d = config_.densify;
  return d.enabled && every(iteration, d.opacity_reset_every) && iteration <= scaled_stop(d.stop) &&
         config_.train.iterations - iteration >= opacity_recovery();
}

bool Schedule::prunes_free_space(int64_t iteration) const { return every(iteration, config_.densify.free_space_every); }

bool Schedule::raises_scales(int64_t iteration) const {
  return config_.optimizer.scale_min_pixels > 0 &&
         (every(iteration, kRaiseScalesEvery) || iteration == config_.train.iterations);
}

bool Schedule::aligns_prior_depth(int64_t iteration) const {
  return facts_.prior_depth == PriorDepthKind::kMetric && config_.loss.log_depth > 0 &&
         every(iteration, config_.loss.depth_align_every);
}

bool Schedule::fits_planes(int64_t iteration) const {
  return facts_.prior_depth == PriorDepthKind::kMetric && facts_.semantics && config_.loss.plane_weight > 0 &&
         every(iteration, config_.loss.plane_every);
}

bool Schedule::names_objects(int64_t iteration) const {
  return facts_.semantics && config_.semantic.object_labels &&
         config_.semantic.blend == SemanticBlend::kProbabilities && iteration == config_.train.iterations;
}

bool Schedule::closes_room(int64_t iteration) const {
  return config_.train.closed_room && facts_.semantics && iteration == config_.train.iterations;
}

bool Schedule::lifts_semantics(int64_t iteration) const {
  return facts_.semantics && config_.semantic.lift && iteration == scaled(config_.semantic.lift_at) + 1;
}

double Schedule::opacity_dropout(int64_t iteration) const {
  return iteration <= scaled_stop(config_.train.opacity_dropout_stop) ? config_.train.opacity_dropout * share(iteration)
                                                                      : 0;
}

double Schedule::view_scale(int64_t iteration) const {
  return iteration <= scaled(config_.train.coarse_stop) ? config_.train.coarse_scale : 1.0;
}

McmcRule Schedule::mcmc_rule() const {
  McmcRule rule;
  rule.dead_opacity = to_float(config_.densify.prune_opacity);
  rule.growth = config_.densify.growth;
  rule.max_gaussians = facts_.max_gaussians;
  rule.morton_order = config_.densify.morton_order;
  return rule;
}

double Schedule::position_noise(int64_t iteration) const {
  if (!uses_mcmc()) return 0;
  const OptimizerConfig& o = config_.optimizer;
  return config_.densify.noise * log_linear(o.position, o.position_end, share(iteration)) * facts_.extent;
}

DensityRule Schedule::density_rule(int64_t iteration) const {
  const DensifyConfig& d = config_.densify;
  DensityRule rule;
  rule.gradient_threshold = to_float(d.gradient);
  rule.gradient_abs_threshold = to_float(d.gradient_abs);
  rule.small_scale = to_float(d.small_scale * facts_.extent);
  rule.prune_opacity = to_float(d.prune_opacity);
  rule.prune_scale = iteration > scaled(d.prune_scale_start) ? to_float(d.prune_scale * facts_.extent) : 0;
  rule.max_gaussians = facts_.max_gaussians;
  rule.morton_order = d.morton_order;
  // A sparse start has everything still to grow; only a dense one is restricted to what it misses.
  if (facts_.dense_start) {
    rule.residual_quantile = to_float(d.residual_quantile);
    rule.unsupported_min = to_float(d.unsupported_min);
  }
  return rule;
}

}  // namespace aligngs
