// Changes of a training's scene between two steps: growth, resets, planes, walls that no photo shows, names.
#include <fmt/format.h>

#include <limits>

#include "core/error.h"
#include "core/log.h"
#include "train/closed_room.h"
#include "train/photo_labels.h"
#include "train/plane_targets.h"
#include "train/scene_maintenance.h"
#include "train/trainer.h"

namespace aligngs {

void Trainer::maintain_scene(int64_t iteration, EventLog& events) {
  const RasterSettings raster = schedule_.request(iteration).raster;
  if (schedule_.densifies(iteration)) {
    events.restructured(iteration, "densify",
                        schedule_.uses_mcmc()
                            ? grow_by_mcmc(engine_, schedule_.mcmc_rule(), density_random_)
                            : control_density(engine_, schedule_.density_rule(iteration), density_random_));
  }
  if (schedule_.resets_opacity(iteration)) {
    engine_.reset_opacity(kResetOpacity);
    events.message(iteration, "opacity_reset", fmt::format("opacities capped at {}", kResetOpacity));
  }
  if (schedule_.prunes_free_space(iteration)) {
    events.restructured(
        iteration, "free_space",
        prune_free_space(engine_, in_.guides, state_.depth_scales, in_.config, state_.facts.extent, raster, pool_));
  }
  if (schedule_.raises_scales(iteration))
    raise_small_scales(engine_, in_.guides, in_.config.optimizer.scale_min_pixels, pool_);
  if (schedule_.aligns_prior_depth(iteration)) {
    align_to_renderings(engine_, in_.guides, in_.known_scales, in_.free_scales, in_.config.loss.depth_align_limit,
                        raster, state_.depth_scales);
  }
  if (schedule_.fits_planes(iteration)) fit_planes_now(iteration, events);
  if (schedule_.closes_room(iteration)) close_room_now(iteration, events);
  if (schedule_.names_objects(iteration)) name_objects_now(iteration, events);
  if (engine_.size() > 0) return;
  throw Error(
      {ErrorKind::kFailed, fmt::format("no Gaussian was left after iteration {}", iteration), folder_.path(), "densify",
       "check the scene with 'aligngs data check'; prune less (densify.prune_opacity, densify.free_space_every=0)"});
}

RenderOptions Trainer::labelled_rendering(int64_t iteration) const {
  RenderOptions render;
  render.raster = schedule_.request(iteration).raster;
  render.semantic_blend = in_.config.semantic.blend;
  return render;
}

void Trainer::fit_planes_now(int64_t iteration, EventLog& events) {
  const PlaneSurfaces surfaces =
      in_.config.data.refine_tables ? PlaneSurfaces::kLayoutAndTables : PlaneSurfaces::kLayout;
  const std::vector<PlaneClass> classes = plane_classes(in_.labels, surfaces);
  state_.planes = fit_plane_targets(
      engine_, {in_.guides, classes, state_.depth_scales, labelled_rendering(iteration), in_.config.data.refine_square},
      pool_);
  give_views();
  events.message(
      iteration, "planes",
      fmt::format("planes of walls, floor and ceiling under {:.0f} % of the pixels", 100 * state_.planes.share()));
}

void Trainer::close_room_now(int64_t iteration, EventLog& events) {
  const size_t cap = state_.facts.max_gaussians;
  const size_t most = cap > 0 ? most_in_closed_room(cap) : std::numeric_limits<size_t>::max();
  const size_t added =
      close_room(engine_, {in_.guides, in_.labels, state_.facts.extent, most, labelled_rendering(iteration)}, pool_);
  if (added == 0) return;
  events.message(iteration, "closed_room",
                 fmt::format("{} Gaussians for walls, floor and ceiling that no photo shows", added));
  log_info("closed room: {} Gaussians for walls, floor and ceiling that no photo shows", added);
}

/// Before the last checkpoint, so that whoever opens the run, edits it or goes on with it finds the same rows.
void Trainer::name_objects_now(int64_t iteration, EventLog& events) {
  PhotoLabelInputs inputs;
  inputs.views = in_.load_views(1);
  for (size_t v = 0; v < inputs.views.size(); ++v) {
    inputs.views[v].data.camera.world_to_camera = in_.guides[v].camera.world_to_camera;
    inputs.near_planes.push_back(in_.guides[v].near_plane);
  }
  inputs.raster = schedule_.request(iteration).raster;
  inputs.extent = state_.facts.extent;
  EngineState state;  // without moments, three times the model, where nothing goes on after the end
  const bool goes_on = in_.config.checkpoint.keep_finished;
  if (goes_on)
    engine_.save_state(state);
  else
    engine_.store(state.model);
  PhotoLabelReport report = vote_label_rows(state.model, std::move(inputs), pool_);
  if (report.regions == 0) return;
  neighbours_ = std::move(report.neighbours);
  if (goes_on)
    engine_.load_state(state);
  else
    engine_.load(state.model);
  events.message(
      iteration, "labels",
      fmt::format(
          "{} regions named by the photos, {} of them against their commonest name; {} Gaussians moved at outlines",
          report.regions, report.renamed, report.moved));
}

void Trainer::handle_non_finite(const StepReport& report, int view, EventLog& events) {
  ++state_.non_finite_steps;
  const NonFinite& bad = report.non_finite;
  const std::string& name = in_.guides[static_cast<size_t>(view)].name;
  const std::string what =
      bad.gaussian >= 0
          ? fmt::format("iteration {}: {} of Gaussian {} became non-finite in view {}", state_.iteration, bad.term,
                        bad.gaussian, name)
          : fmt::format("iteration {}: loss {} became non-finite in view {}", state_.iteration, bad.term, name);
  log_warning("{}; the step was rolled back{}", what, bad.gaussian >= 0 ? " and the Gaussian removed" : "");
  events.message(state_.iteration, "non_finite", what);
  if (bad.gaussian >= 0) remove_gaussian(engine_, bad.gaussian);
  if (state_.non_finite_steps < kNonFiniteLimit || engine_.size() == 0) return;
  write_state();
  throw Error(
      {ErrorKind::kFailed, fmt::format("{}; {} such steps are the limit", what, kNonFiniteLimit), folder_.path(),
       bad.term,
       "check this view with 'aligngs data check'; lower the learning rates (optimizer.*) or loss weights (loss.*)"});
}

}  // namespace aligngs
