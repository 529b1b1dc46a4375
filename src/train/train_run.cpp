#include "train/train_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/log.h"
#include "core/memory_budget.h"
#include "core/shell_word.h"
#include "core/stop_signal.h"
#include "core/version.h"
#include "gaussians/object_labels.h"
#include "io/atomic_file.h"
#include "io/output_place.h"
#include "refine/refined_scene.h"
#include "train/camera_outputs.h"
#include "train/finished_run.h"
#include "train/first_state.h"
#include "train/live_snapshot.h"
#include "train/memory_fit.h"
#include "train/neighbour_choice.h"
#include "train/run_control.h"
#include "train/run_outputs.h"
#include "train/scene_maintenance.h"
#include "train/trainer.h"
#include "train/training_scene.h"
#include "train/voted_objects.h"

namespace aligngs {
namespace {

RunMode mode_of(const TrainOptions& options) {
  return options.overwrite ? RunMode::kOverwrite : options.resume ? RunMode::kResume : RunMode::kNew;
}

std::string resume_command_of(const TrainOptions& options) {
  if (!options.resume_command.empty()) return options.resume_command;
  return fmt::format("aligngs train {}-o {} --resume",
                     options.scene.empty() ? "" : quote_word(options.scene.string()) + " ",
                     quote_word(options.run.string()));
}

/// One run from checked settings to its outputs; train_run handles its errors.
class Run {
 public:
  Run(const TrainOptions& options, const ResolvedRun& resolved, const EngineFactory& make_engine)
      : options_(options),
        config_(resolved.config),
        resolved_(resolved),
        folder_(options.run),
        make_engine_(make_engine),
        budget_(options.memory_limit) {}

  void open_scene_and_check();
  /// Before anything of the run is written: a resumed run keeps its scene.
  void require_own_scene() const;
  void prepare_folder();
  TrainResult train();
  void record_failure(RunStatus status, const std::string& reason) noexcept;

 private:
  void record_end(RunStatus status, const std::string& reason);
  std::filesystem::path scene_folder() const;
  /// The state to go on from, or that of a new start (`fresh`).
  TrainingState start(Engine& engine, const std::vector<TrainingView>& views, TrainerInputs& inputs, bool& fresh);
  void find_scene_facts(const std::vector<TrainingView>& views, TrainingFacts& facts) const;
  void warn(const std::string& message);
  std::vector<std::vector<int>> neighbours_of(const std::vector<GuideView>& guides);

  const TrainOptions& options_;
  TrainConfig config_;
  const ResolvedRun& resolved_;
  RunFolder folder_;
  const EngineFactory& make_engine_;
  MemoryBudget budget_;
  std::optional<ThreadPool> pool_;
  TrainingScene in_;
  RunRecord record_;
};

std::filesystem::path Run::scene_folder() const {
  if (!resolved_.exists || !resolved_.record) {
    if (options_.scene.empty()) throw_usage("no scene folder is given", "aligngs train SCENE -o RUN");
    return options_.scene;
  }
  return scene_of_run(folder_.path(), *resolved_.record, options_.scene);
}

void Run::warn(const std::string& message) {
  log_warning("{}", message);
  record_.warnings.push_back(message);
}

void Run::open_scene_and_check() {
  const std::filesystem::path folder = scene_folder();
  folder_.require_apart_from(folder);
  in_ = open_training_scene(folder, config_, {options_.strict, options_.require_priors, options_.labels_unwanted});
  budget_.add("training views", predicted_view_bytes(in_.scene, config_, in_.use));
  budget_.require("training", kMemoryRemedy);
}

void Run::require_own_scene() const {
  if (!resolved_.exists || !resolved_.record) return;
  const RunRecord& record = *resolved_.record;
  std::error_code none;
  const bool begun = !record.trained.empty() || std::filesystem::directory_iterator(folder_.checkpoints(), none) !=
                                                    std::filesystem::directory_iterator();
  if (begun && !record.fingerprint.empty() && record.fingerprint != in_.fingerprint)
    refuse_other_scene(folder_.path(), in_.scene.folder);
}

void Run::prepare_folder() {
  folder_.prepare(mode_of(options_));
  if (resolved_.exists && resolved_.record) record_ = *resolved_.record;
  if (record_.started.empty()) record_.started = utc_now();
  record_.status = RunStatus::kRunning;
  record_.stage = RunStage::kTrain;
  record_.command = options_.command_line;
  record_.version = version();
  record_.seed = config_.train.seed;
  record_.updated = utc_now();
  record_.finished.clear();
  record_.reason.clear();
  record_.scene = relative_scene_path(folder_.path(), in_.scene.folder);
  record_.fingerprint = in_.fingerprint;
  record_.left_out.clear();
  for (const LeftOut& view : in_.scene.left_out) record_.left_out.push_back(view.name);
  record_.warnings.clear();
  record_.trained.clear();
  record_.prior_depth = in_.use.depth_note;
  if (!options_.camera_note.empty()) record_.cameras = options_.camera_note;
  for (const std::string& message : in_.use.warnings) warn(message);
  // A run that exists keeps its file unless its end moves: every byte of it is the user's. A new run's record comes
  // first, because it tells whose folder this is.
  if (!resolved_.exists) write_run_record(folder_.record(), record_);
  if (!resolved_.exists || resolved_.extended) write_file_atomically(folder_.config(), config_to_toml(config_));
  write_run_record(folder_.record(), record_);
}

TrainingState Run::start(Engine& engine, const std::vector<TrainingView>& views, TrainerInputs& inputs, bool& fresh) {
  PriorScales aligned = is_refined_scene(in_.scene.folder)
                            ? scales_of_agreeing_depth(inputs.guides.size())
                            : align_to_points(inputs.guides, in_.scene.cloud, config_.loss.depth_align_limit);
  free_unplaced(in_.use, aligned);
  inputs.known_scales = aligned.known;
  inputs.free_scales = aligned.free;
  std::optional<TrainingState> saved;
  if (resolved_.exists) saved = read_latest_checkpoint(folder_.checkpoints(), in_.fingerprint);
  remove_checkpoints_beyond(folder_.checkpoints(), saved ? saved->iteration : -1);
  fresh = !saved;
  if (saved) return std::move(*saved);
  FirstState first = first_state({in_, config_, views, aligned.scale}, engine, budget_, *pool_);
  if (!first.warning.empty()) warn(first.warning);
  return std::move(first.state);
}

void Run::find_scene_facts(const std::vector<TrainingView>& views, TrainingFacts& facts) const {
  facts.training_views = static_cast<int>(in_.scene.train.size());
  facts.image_side = 0;
  for (const TrainingView& view : views) {
    facts.image_side = std::max({facts.image_side, view.data.camera.width, view.data.camera.height});
  }
  facts.prior_depth = in_.use.depth;
  facts.network_cameras = in_.scene.has_network_depth();
  facts.semantics = in_.use.semantics;
  facts.extent = static_cast<float>(in_.extent);
}

std::vector<std::vector<int>> Run::neighbours_of(const std::vector<GuideView>& guides) {
  std::vector<Camera> cameras;
  for (const GuideView& guide : guides) cameras.push_back(guide.camera);
  std::vector<std::vector<int>> neighbours = choose_neighbours(cameras, in_.extent);
  const auto alone = std::count_if(neighbours.begin(), neighbours.end(), [](const auto& n) { return n.empty(); });
  if (alone > 0) {
    warn(fmt::format("{} of {} training views have no neighbour: there the multi-view terms do not act", alone,
                     neighbours.size()));
  }
  return neighbours;
}

TrainResult Run::train() {
  pool_.emplace(options_.threads);
  std::unique_ptr<Engine> engine = make_engine_(options_.threads);
  const bool multi_view = config_.loss.multi_view_geometric > 0 || config_.loss.multi_view_photometric > 0;
  if (multi_view && !engine->offers_multi_view()) {
    throw Error({ErrorKind::kUsage, fmt::format("{} does not have the multi-view terms", engine->device_name()),
                 folder_.path(), "loss.multi_view_photometric",
                 "use --device cpu, or set loss.multi_view_geometric=0 and loss.multi_view_photometric=0"});
  }
  record_.device = engine->device_name();
  write_run_record(folder_.record(), record_);
  write_camera_outputs(folder_, in_.scene, config_);  // the photos' places can be looked at from the start

  TrainerInputs inputs;
  inputs.config = config_;
  inputs.fingerprint = in_.fingerprint;
  inputs.labels = in_.scene.labels;
  inputs.resume_command = resume_command_of(options_);
  inputs.progress = options_.progress;
  std::vector<TrainingView> views = load_training_views(in_.scene, config_, in_.use, *pool_);
  inputs.guides = guides_of(views, in_.use, config_, in_.extent);
  if (multi_view) {
    inputs.neighbours = neighbours_of(inputs.guides);
  }
  bool fresh = true;
  TrainingState state = start(*engine, views, inputs, fresh);
  find_scene_facts(views, state.facts);
  inputs.load_views = [this](double scale) {
    TrainConfig at_scale = config_;
    at_scale.data.scale *= scale;
    return load_training_views(in_.scene, at_scale, in_.use, *pool_);
  };
  const double scale = Schedule(config_, state.facts).view_scale(state.iteration + 1);
  if (scale != 1) {
    views.clear();
    views = inputs.load_views(scale);
  }
  engine->prepare(
      {std::move(views), static_cast<int>(config_.semantic.active_top), fresh ? &state.engine.model : nullptr});
  Trainer trainer(std::move(inputs), *engine, folder_, record_, *pool_);
  if (fresh) state = trainer.initial_state(state.depth_scales, state.facts);
  state = trainer.run(std::move(state));

  if (!state.motions.empty()) {
    apply_motions(state.motions, in_.scene);
    write_camera_outputs(folder_, in_.scene, config_);
  }
  GaussianModel model;
  engine->store(model);
  GaussianLabels labels;
  TrainResult result;
  if (model.semantic_channels > 0) {
    result.soft = std::make_shared<const SoftLabels>(
        smoothed_labels(model, robust_extent(in_.scene), *pool_, trainer.neighbours()));
    labels = best_labels(*result.soft, in_.scene.labels);
    const size_t objects = number_objects(model, in_.scene, config_, labels, *pool_).size();
    if (votes_for_objects(in_.scene, config_)) log_info("{} objects by votes of the photos' segments", objects);
  }
  if (!state.in_scene_file) write_gaussian_ply(folder_.scene_ply(), model);
  write_label_files(folder_.path(), model, in_.scene.labels, labels);
  record_.trained = utc_now();
  record_end(RunStatus::kDone, "all iterations done");
  result.iterations = state.iteration;
  result.gaussians = model.size();
  result.seconds = state.seconds;
  result.psnr = state.psnr_average;
  result.warnings = record_.warnings;
  return result;
}

/// The reason for which a run ends must reach the caller even when it cannot be written down.
void Run::record_failure(RunStatus status, const std::string& reason) noexcept {
  const StopDeferral until_written;
  try {
    record_end(status, reason);
  } catch (const std::exception& error) {
    log_warning("{} cannot be written: {}", folder_.record().string(), error.what());
  }
}

void Run::record_end(RunStatus status, const std::string& reason) {
  record_.status = status;
  record_.reason = reason;
  record_.updated = record_.finished = utc_now();
  write_run_record(folder_.record(), record_);
}

}  // namespace

TrainResult train_run(const TrainOptions& options) {
  return train_run(options, options.make_engine ? options.make_engine : EngineFactory(make_cpu_engine));
}

TrainResult train_run(const TrainOptions& options, const EngineFactory& make_engine) {
  const RunFolder folder(options.run);
  const ResolvedRun resolved = resolve_run(options);
  folder.check(mode_of(options));
  if (resolved.finished) {
    require_scene_of_finished(options, *resolved.record);
    log_info("the training in {} is finished", options.run.string());
    return result_of_finished(*resolved.record);
  }
  if (RunControl(options.run).active()) {
    throw Error({ErrorKind::kUsage, "another process is working on this run", options.run, "-o",
                 "wait until it has ended, stop it, or name another folder"});
  }
  Run run(options, resolved, make_engine);
  run.open_scene_and_check();
  run.require_own_scene();
  run.prepare_folder();
  const RunLock lock(options.run);
  struct RemoveSnapshot {
    const RunFolder& folder;
    ~RemoveSnapshot() { remove_live_snapshot(folder); }
  } remove_snapshot{folder};
  try {
    return run.train();
  } catch (const Error& error) {
    run.record_failure(error.kind() == ErrorKind::kInterrupted ? RunStatus::kStopped : RunStatus::kFailed,
                       error.details().message);
    if (error.kind() != ErrorKind::kInterrupted) throw;
    Error::Details details = error.details();
    details.remedy = "resume with: " + resume_command_of(options);
    throw Error(details);
  } catch (const std::bad_alloc&) {
    run.record_failure(RunStatus::kFailed, "memory ran out");
    throw_resources(options.run, "memory ran out although it was budgeted", kMemoryRemedy);
  } catch (const std::exception& error) {
    run.record_failure(RunStatus::kFailed, error.what());
    throw;
  }
}

}  // namespace aligngs
