#include "train/trainer.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/steady_seconds.h"
#include "core/stop_signal.h"
#include "gaussians/gaussian_ply.h"
#include "train/neighbour_choice.h"
#include "train/plane_targets.h"
#include "train/random_purpose.h"

namespace aligngs {
namespace {

// A checkpoint within a quarter of their distance from the end is left to the last one.
constexpr int64_t kSoonOver = 4;
constexpr double kAverageKeep = 0.98;  // running mean over about 50 steps: a few epochs of a small scene

Random generator(const TrainConfig& config, RandomPurpose purpose) {
  return random_of(static_cast<uint64_t>(config.train.seed), purpose);
}

/// A function of seed and iteration alone, so that a resumed run sees the colours of the whole one.
void set_random_background(const TrainConfig& config, int64_t iteration, RasterSettings& raster) {
  Random random = generator(config, RandomPurpose::kBackground).fork(static_cast<uint64_t>(iteration));
  for (float& channel : raster.background) channel = static_cast<float>(random.uniform());
}

/// The same holds for the Gaussians that a step leaves out.
OpacityDropout draw_dropout(const TrainConfig& config, int64_t iteration, double rate) {
  return {static_cast<float>(rate),
          generator(config, RandomPurpose::kDropout).fork(static_cast<uint64_t>(iteration)).next()};
}

}  // namespace

Trainer::Trainer(TrainerInputs inputs, Engine& engine, const RunFolder& folder, RunRecord& record, ThreadPool& pool)
    : in_(std::move(inputs)),
      engine_(engine),
      folder_(folder),
      record_(record),
      pool_(pool),
      schedule_(in_.config, TrainingFacts{}),
      order_(static_cast<int>(in_.guides.size()), generator(in_.config, RandomPurpose::kViewOrder).next()),
      density_random_(generator(in_.config, RandomPurpose::kDensity)),
      control_(folder.path()) {
  for (const GuideView& guide : in_.guides) poses_.push_back(guide.camera.world_to_camera);
}

TrainingState Trainer::initial_state(const std::vector<float>& depth_scales, const TrainingFacts& facts) const {
  TrainingState state;
  state.order = order_.state();
  state.density_random = density_random_.state();
  state.depth_scales = depth_scales;
  state.facts = facts;
  return state;
}

TrainingState Trainer::run(TrainingState state) {
  const StopDeferral until_checkpoint;  // stop_here() writes one first
  state_ = std::move(state);
  if (state_.depth_scales.size() != in_.guides.size()) {
    throw_bad_input(folder_.checkpoints(), "depth_scales", "the checkpoint has another number of views",
                    "start again with --overwrite");
  }
  if (state_.engine.model.size() > 0) {
    if (state_.trainable)
      engine_.load_state(state_.engine);
    else
      engine_.load(state_.engine.model);
    checkpointed_ = state_.iteration;
  }
  state_.engine = {};  // the engine owns the parameters from here on; no second copy is kept
  order_.set_state(state_.order);
  density_random_.set_state(state_.density_random);
  schedule_ = Schedule(in_.config, state_.facts);

  if (!state_.motions.empty() && state_.motions.size() != in_.guides.size()) {
    throw_bad_input(folder_.checkpoints(), "camera_motions", "the checkpoint has another number of views",
                    "start again with --overwrite");
  }
  view_scale_ = schedule_.view_scale(state_.iteration + 1);
  if (state_.planes.empty()) {
    place_cameras();
  } else {
    give_views();
  }

  const int64_t last = in_.config.train.iterations;
  if (!state_.trainable && state_.iteration < last) {
    throw_bad_input(folder_.checkpoints(), "checkpoint.keep_finished",
                    "the checkpoint of a finished run does not have the state of its optimiser",
                    "start again with --overwrite");
  }
  EventLog events(folder_.events(), state_.iteration);
  Progress progress(in_.progress, "train", static_cast<uint64_t>(last), static_cast<uint64_t>(state_.iteration));
  seconds_before_ = state_.seconds;
  iterations_before_ = state_.iteration;
  begun_ = steady_seconds();
  while (state_.iteration < last) {
    if (stop_requested()) stop_here();
    obey();
    iterate(state_.iteration + 1, events);
    const int64_t every = in_.config.checkpoint.every;
    if (state_.iteration % every == 0 && kSoonOver * (last - state_.iteration) > every) write_state();
    update_progress(report_, progress);
  }
  if (checkpointed_ != state_.iteration) write_state();
  return state_;
}

void Trainer::iterate(int64_t iteration, EventLog& events) {
  const double begun = steady_seconds();
  StepRequest request = schedule_.request(iteration);
  if (schedule_.view_scale(iteration) != view_scale_) {
    view_scale_ = schedule_.view_scale(iteration);
    give_views();
    events.message(iteration, "resolution", fmt::format("views at {} of the working resolution", view_scale_));
  }
  if (schedule_.lifts_semantics(iteration)) engine_.lift_semantics(request.raster);
  request.view = order_.next();
  request.losses.prior_depth_scale = state_.depth_scales[static_cast<size_t>(request.view)];
  request.raster.near_plane = in_.guides[static_cast<size_t>(request.view)].near_plane;
  if (in_.config.train.random_background) set_random_background(in_.config, iteration, request.raster);
  if (in_.config.train.opacity_dropout > 0) {
    request.raster.dropout = draw_dropout(in_.config, iteration, schedule_.opacity_dropout(iteration));
  }
  if (!in_.neighbours.empty()) {
    const DrawnNeighbour drawn = draw_neighbour(in_.neighbours[static_cast<size_t>(request.view)],
                                                static_cast<uint64_t>(in_.config.train.seed), iteration);
    if (drawn.view >= 0) {
      request.neighbour = {drawn.view, in_.guides[static_cast<size_t>(drawn.view)].near_plane, drawn.seed};
    }
  }
  const PoseRates pose_rates = schedule_.pose_rates(iteration);
  request.pose_gradient = pose_rates.active() && request.view != 0;  // the first camera holds the world in its place
  report_ = engine_.step(request);
  state_.iteration = iteration;
  if (request.pose_gradient && !report_.non_finite.found) move_camera(static_cast<size_t>(request.view), pose_rates);
  if (const double noise = schedule_.position_noise(iteration); noise > 0) {
    engine_.add_position_noise(
        {static_cast<float>(noise),
         generator(in_.config, RandomPurpose::kNoise).fork(static_cast<uint64_t>(iteration)).next()});
  }
  if (report_.non_finite.found) {
    handle_non_finite(report_, request.view, events);
  } else {
    const double psnr = report_.losses.psnr;
    if (std::isfinite(psnr)) {
      state_.psnr_average =
          state_.psnr_average == 0 ? psnr : kAverageKeep * state_.psnr_average + (1 - kAverageKeep) * psnr;
    }
    if (iteration % in_.config.train.log_every == 0 || iteration == in_.config.train.iterations) {
      events.step({iteration, in_.guides[static_cast<size_t>(request.view)].name, &report_, engine_.size(),
                   steady_seconds() - begun});
    }
  }
  maintain_scene(iteration, events);
}

void Trainer::place_cameras() {
  for (size_t v = 0; v < state_.motions.size(); ++v) place_camera(v);
}

void Trainer::place_camera(size_t view) {
  Rigidd& pose = in_.guides[view].camera.world_to_camera;
  pose = moved(poses_[view], state_.motions[view]);
  engine_.set_pose(static_cast<int>(view), pose);
}

void Trainer::move_camera(size_t view, const PoseRates& rates) {
  if (state_.motions.empty()) state_.motions.resize(in_.guides.size());
  update_motion(report_.pose, rates, state_.motions[view]);
  place_camera(view);
}

void Trainer::give_views() {
  std::vector<TrainingView> views = in_.load_views(view_scale_);
  draw_to_planes(state_.planes, in_.config.loss.plane_weight, views);
  engine_.set_training_views(std::move(views));
  place_cameras();
}

void Trainer::write_state() {
  state_.order = order_.state();
  state_.density_random = density_random_.state();
  state_.seconds = seconds_before_ + seconds_since_start();
  // Stages and edits need the scene alone of a finished run.
  state_.trainable = in_.config.checkpoint.keep_finished || state_.iteration < in_.config.train.iterations;
  state_.in_scene_file = !state_.trainable;
  if (state_.trainable) {
    engine_.save_state(state_.engine);
  } else {
    engine_.store(state_.engine.model);
    write_gaussian_ply(folder_.scene_ply(), state_.engine.model);  // first: the checkpoint refers to it
  }
  write_checkpoint(folder_.checkpoints(), state_, in_.fingerprint, state_.trainable ? in_.config.checkpoint.keep : 1);
  state_.engine = {};
  checkpointed_ = state_.iteration;
  record_.updated = utc_now();
  record_.train.seconds = state_.seconds;
  record_.train.iterations = state_.iteration;
  record_.train.gaussians = engine_.size();
  record_.train.iterations_per_second = state_.seconds > 0 ? static_cast<double>(state_.iteration) / state_.seconds : 0;
  record_.train.peak_memory_bytes = peak_memory_bytes();
  write_run_record(folder_.record(), record_);
}

void Trainer::update_progress(const StepReport& report, Progress& progress) const {
  if (!progress.due() && state_.iteration < in_.config.train.iterations) {
    progress.update(static_cast<uint64_t>(state_.iteration));
    return;
  }
  std::string text = fmt::format("PSNR {:.2f} dB  loss {:.4f}", state_.psnr_average, report.losses.total);
  const char* separator = " (";
  for (const LossRow& row : kLossCatalogue) {
    if (row.progress.empty() || !(report.losses[row.loss] > 0)) continue;
    text += fmt::format("{}{} {:.3g}", separator, row.progress, report.losses[row.loss]);
    separator = ", ";
  }
  if (separator == std::string_view(", ")) text += ")";
  progress.update(static_cast<uint64_t>(state_.iteration), fmt::format("{}  {} Gaussians ", text, engine_.size()));
}

double Trainer::seconds_since_start() const { return steady_seconds() - begun_; }

}  // namespace aligngs
