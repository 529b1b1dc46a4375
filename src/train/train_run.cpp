#include "train/train_run.h"
#include "core/version.h"
#include "scene/ignored_classes.h"
#include "scene/view_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/log.h"
#include "core/memory_budget.h"
#include "core/shell_word.h"
#include "core/stop_signal.h"
#include "gaussians/morton_order.h"
#include "gaussians/object_labels.h"
#include "io/atomic_file.h"
#include "io/colmap.h"
#include "io/output_place.h"
#include "refine/refined_scene.h"
#include "train/camera_outputs.h"
#include "train/live_snapshot.h"
#include "train/memory_fit.h"
#include "train/neighbour_choice.h"
#include "train/random_purpose.h"
#include "train/run_control.h"
#include "train/run_outputs.h"
#include "train/scene_maintenance.h"
#include "train/start_model.h"
#include "train/trainer.h"
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

[[noreturn]] void refuse_other_scene(const std::filesystem::path& run, const std::filesystem::path& scene) {
  throw_bad_input(
      run, "scene",
      fmt::format("this run was trained on another scene than {}, or the scene has changed since", scene.string()),
      "give the scene the run began with, or start again with --overwrite");
}

/// A finished run keeps its measurements: they are not made again with the scene of another room.
void require_scene_of_finished(const TrainOptions& options, const RunRecord& record) {
  if (options.scene.empty() || record.fingerprint.empty()) return;
  if (real_place(options.scene) == real_place(scene_of_run(options.run, record))) return;
  Scene scene = open_scene(options.scene);
  leave_out_views(scene, record.left_out);
  if (scene_fingerprint(scene) != record.fingerprint) refuse_other_scene(options.run, options.scene);
}

TrainResult result_of_finished(const RunRecord& record) {
  TrainResult result;
  result.already_finished = true;
  result.iterations = record.train.iterations;
  result.gaussians = record.train.gaussians;
  result.seconds = record.train.seconds;
  result.warnings = record.warnings;
  return result;
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
  void record_failure(const std::string& status, const std::string& reason) noexcept;

 private:
  void record_end(const std::string& status, const std::string& reason);
  std::filesystem::path scene_folder() const;
  /// The state to go on from, or that of a new start (`fresh`).
  TrainingState start(Engine& engine, const std::vector<TrainingView>& views, TrainerInputs& inputs, bool& fresh);
  void warn(const std::string& message);
  std::vector<std::vector<int>> neighbours_of(const std::vector<GuideView>& guides);

  const TrainOptions& options_;
  TrainConfig config_;
  const ResolvedRun& resolved_;
  RunFolder folder_;
  const EngineFactory& make_engine_;
  MemoryBudget budget_;
  std::optional<ThreadPool> pool_;
  Scene scene_;
  PriorUse use_;
  std::string fingerprint_;
  double extent_ = 1;
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
  scene_ = open_scene(folder);
  scene_.ignored = ignored_classes(scene_.labels, config_.data.ignore);
  if (scene_.train.empty())
    throw_bad_input(folder, "train", "the scene has no training view", "list training views in split.json");
  if (const std::string choice = choice_of_model(folder); !choice.empty()) log_warning("{}", choice);
  log_info("checking {} views", scene_.train.size() + scene_.test.size());
  const SceneProblem* first = nullptr;
  size_t fatal = 0;
  const std::vector<SceneProblem> problems = leave_out_bad_views(scene_, check_scene(scene_));
  for (const SceneProblem& problem : problems) {
    if (!problem.fatal) {
      log_warning("{}: {}: {}", problem.path.string(), problem.field, problem.message);
      continue;
    }
    if (!first) first = &problem;
    ++fatal;
  }
  if (first) {
    std::string message = first->message;
    if (fatal > 1) message += fmt::format(" (and {} more problems: 'aligngs data check' lists them)", fatal - 1);
    throw_bad_input(first->path, first->field, message, first->remedy);
  }
  const size_t used = scene_.train.size() + scene_.test.size();
  require_enough(folder, used, scene_.left_out, kFewestTrainingViews, options_.strict, "views");
  warn_left_out(used, scene_.left_out, "views");
  use_ = decide_prior_use(scene_, config_);
  if (options_.require_priors && !use_.warnings.empty()) {
    throw Error(
        {ErrorKind::kWeights, use_.warnings.front(), folder, {}, "make the priors, or leave --require-priors out"});
  }
  if (!use_.depth_note.empty())
    log_info("prior depth of {}: {}", scene_.prior_source.empty() ? "unknown origin" : scene_.prior_source,
             use_.depth_note);
  check_prior_confidence(scene_, config_, use_);
  fingerprint_ = scene_fingerprint(scene_);
  extent_ = robust_extent(scene_);
  budget_.add("training views", predicted_view_bytes(scene_, config_, use_));
  budget_.require("training", kMemoryRemedy);
}

void Run::require_own_scene() const {
  if (!resolved_.exists || !resolved_.record) return;
  const RunRecord& record = *resolved_.record;
  std::error_code none;
  const bool begun = !record.trained.empty() || std::filesystem::directory_iterator(folder_.checkpoints(), none) !=
                                                    std::filesystem::directory_iterator();
  if (begun && !record.fingerprint.empty() && record.fingerprint != fingerprint_)
    refuse_other_scene(folder_.path(), scene_.folder);
}

void Run::prepare_folder() {
  folder_.prepare(mode_of(options_));
  if (resolved_.exists && resolved_.record) record_ = *resolved_.record;
  if (record_.started.empty()) record_.started = utc_now();
  record_.status = "running";
  record_.stage = "train";
  record_.command = options_.command_line;
  record_.version = version();
  record_.seed = config_.train.seed;
  record_.updated = utc_now();
  record_.finished.clear();
  record_.reason.clear();
  record_.scene = relative_scene_path(folder_.path(), scene_.folder);
  record_.fingerprint = fingerprint_;
  record_.left_out.clear();
  for (const LeftOut& view : scene_.left_out) record_.left_out.push_back(view.name);
  record_.warnings.clear();
  record_.trained.clear();
  record_.prior_depth = use_.depth_note;
  if (!options_.camera_note.empty()) record_.cameras = options_.camera_note;
  for (const std::string& message : use_.warnings) warn(message);
  // A run that exists keeps its file unless its end moves: every byte of it is the user's. A new run's record comes
  // first: it is what
  // says whose folder this is.
  if (!resolved_.exists) write_run_record(folder_.record(), record_);
  if (!resolved_.exists || resolved_.extended) write_file_atomically(folder_.config(), config_to_toml(config_));
  write_run_record(folder_.record(), record_);
}

TrainingState Run::start(Engine& engine, const std::vector<TrainingView>& views, TrainerInputs& inputs, bool& fresh) {
  PriorScales aligned = is_refined_scene(scene_.folder)
                            ? scales_of_agreeing_depth(inputs.guides.size())
                            : align_to_points(inputs.guides, scene_.cloud, config_.loss.depth_align_limit);
  free_unplaced(use_, aligned);
  inputs.known_scales = aligned.known;
  inputs.free_scales = aligned.free;
  const std::vector<float>& scales = aligned.scale;
  std::optional<TrainingState> saved;
  if (resolved_.exists) saved = read_latest_checkpoint(folder_.checkpoints(), fingerprint_);
  remove_checkpoints_beyond(folder_.checkpoints(), saved ? saved->iteration : -1);
  fresh = !saved;
  if (saved) return std::move(*saved);
  const int channels = use_.semantics ? scene_.labels.size() : 0;
  size_t pixels = 0, all_pixels = 0;  // of the largest view, of all
  for (const GuideView& guide : inputs.guides) {
    const size_t size = size_t(guide.camera.width) * static_cast<size_t>(guide.camera.height);
    pixels = std::max(pixels, size);
    all_pixels += size;
  }
  const int64_t limit = start_limit(config_, pixels);
  const StartInputs start_inputs{config_,  views, scales,  scene_.cloud, use_.depth,
                                 channels, limit, extent_, *pool_,       is_sensor_depth(scene_.prior_source)};
  StartModel begun =
      make_start_model(start_inputs, random_of(static_cast<uint64_t>(config_.train.seed), RandomPurpose::kStart));
  if (config_.densify.morton_order) sort_by_morton(begun.model);
  log_info("{} Gaussians to start with, from {}", begun.model.size(), begun.dense ? "prior depth" : "points");
  TrainingState state;
  state.depth_scales = scales;
  state.start.dense = begun.dense;
  state.start.has_normals = begun.has_normals;
  state.engine.model = std::move(begun.model);
  const GaussianCap cap = fit_to_engine({config_, state.engine.model.size(), state.start.dense, limit, all_pixels},
                                        {engine, views, channels, pixels}, budget_);
  if (!cap.warning.empty()) warn(cap.warning);
  state.start.max_gaussians = cap.gaussians;
  return state;
}

std::vector<std::vector<int>> Run::neighbours_of(const std::vector<GuideView>& guides) {
  std::vector<Camera> cameras;
  for (const GuideView& guide : guides) cameras.push_back(guide.camera);
  std::vector<std::vector<int>> neighbours = choose_neighbours(cameras, extent_);
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
  write_camera_outputs(folder_, scene_, config_);  // the photos' places can be looked at from the start

  TrainerInputs inputs;
  inputs.config = config_;
  inputs.facts.training_views = static_cast<int>(scene_.train.size());
  inputs.facts.prior_depth = use_.depth;
  inputs.facts.network_cameras = scene_.has_network_depth();
  inputs.facts.semantics = use_.semantics;
  inputs.facts.extent = static_cast<float>(extent_);
  inputs.fingerprint = fingerprint_;
  inputs.labels = scene_.labels;
  inputs.resume_command = resume_command_of(options_);
  inputs.progress = options_.progress;
  std::vector<TrainingView> views = load_training_views(scene_, config_, use_, *pool_);
  for (const TrainingView& view : views) {
    inputs.facts.image_side = std::max({inputs.facts.image_side, view.data.camera.width, view.data.camera.height});
  }
  inputs.guides = guides_of(views, use_, config_, extent_);
  if (multi_view) {
    inputs.neighbours = neighbours_of(inputs.guides);
  }
  bool fresh = true;
  TrainingState state = start(*engine, views, inputs, fresh);
  inputs.load_views = [this](double scale) {
    TrainConfig at_scale = config_;
    at_scale.data.scale *= scale;
    return load_training_views(scene_, at_scale, use_, *pool_);
  };
  const double scale = Schedule(config_, inputs.facts).view_scale(state.iteration + 1);
  if (scale != 1) {
    views.clear();
    views = inputs.load_views(scale);
  }
  engine->prepare(
      {std::move(views), static_cast<int>(config_.semantic.active_top), fresh ? &state.engine.model : nullptr});
  Trainer trainer(std::move(inputs), *engine, folder_, record_, *pool_);
  if (fresh) state = trainer.initial_state(state.depth_scales, state.start);
  state = trainer.run(std::move(state));

  if (!state.motions.empty()) {
    apply_motions(state.motions, scene_);
    write_camera_outputs(folder_, scene_, config_);
  }
  GaussianModel model;
  engine->store(model);
  GaussianLabels labels;
  if (model.semantic_channels > 0) {
    labels = best_labels(smoothed_labels(model, robust_extent(scene_), *pool_), scene_.labels);
    const size_t objects = number_objects(model, scene_, config_, labels, *pool_).size();
    if (votes_for_objects(scene_, config_)) log_info("{} objects by votes of the photos' segments", objects);
  }
  write_scene_files(folder_.path(), model, scene_.labels, labels);
  record_.trained = utc_now();
  record_end("done", "all iterations done");
  TrainResult result;
  result.iterations = state.iteration;
  result.gaussians = model.size();
  result.seconds = state.seconds;
  result.psnr = state.psnr_average;
  result.warnings = record_.warnings;
  return result;
}

/// The reason for which a run ends must reach the caller even when it cannot be written down.
void Run::record_failure(const std::string& status, const std::string& reason) noexcept {
  const StopDeferral until_written;
  try {
    record_end(status, reason);
  } catch (const std::exception& error) {
    log_warning("{} cannot be written: {}", folder_.record().string(), error.what());
  }
}

void Run::record_end(const std::string& status, const std::string& reason) {
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
    log_info("the run in {} is finished: nothing to do", options.run.string());
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
    run.record_failure(error.kind() == ErrorKind::kInterrupted ? "stopped" : "failed", error.details().message);
    if (error.kind() != ErrorKind::kInterrupted) throw;
    Error::Details details = error.details();
    details.remedy = "resume with: " + resume_command_of(options);
    throw Error(details);
  } catch (const std::bad_alloc&) {
    run.record_failure("failed", "memory ran out");
    throw_resources(options.run, "memory ran out although it was budgeted", kMemoryRemedy);
  } catch (const std::exception& error) {
    run.record_failure("failed", error.what());
    throw;
  }
}

}  // namespace aligngs
