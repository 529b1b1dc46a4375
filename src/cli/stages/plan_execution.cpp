#include "cli/stages/plan_execution.h"

#include <optional>

#include "cli/photo_options.h"
#include "cli/stages/pipeline.h"
#include "cli/stages/refine_stage.h"
#include "core/log.h"
#include "io/file_system_error.h"
#include "priors/scene_priors.h"
#include "refine/scene_copy.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// A line for what a person has to know of a step before it is done.
void tell(const PlannedStep& step, const RunPlan& plan) {
  if (step.outlook == Outlook::kLeftOut) {
    if (step.notice == Notice::kInfo) log_info("{}", step.reason);
    if (step.notice == Notice::kWarning) log_warning("{}", step.reason);
    return;
  }
  if (step.step == RunStep::kPoses && plan.cameras.chosen) log_info("{}", step.reason);
  if (!step.terms.empty()) log_warning("{}", step.terms);
}

/// The steps before training. The scene moves to RUN/scene with the first step that changes it.
class ScenePreparation {
 public:
  ScenePreparation(const RunPlan& plan, const RunRequest& request, const PlanExecutionOptions& options,
                   const ModelStore& store, const CommandContext& context)
      : plan_(plan),
        request_(request),
        options_(options),
        store_(store),
        context_(context),
        folder_(plan.begun || plan.from_photos() ? plan.scene : plan.source) {}

  /// The scene that is trained.
  fs::path prepare() {
    for (const PlannedStep& step : plan_.steps) {
      if (step.step >= RunStep::kTrain) break;
      const bool expected = step.outlook == Outlook::kExpected;
      const PlannedStep settled = expected ? settled_step(step, scene(), request_, plan_, store_) : step;
      tell(settled, plan_);
      if (settled.outlook == Outlook::kLeftOut) continue;
      carry_out(settled);
      opened_.reset();
    }
    return folder_;
  }

  /// How well cameras of a sensor agree with the photos; empty where that was not measured.
  const std::string& camera_note() const { return camera_note_; }

 private:
  void carry_out(const PlannedStep& step) {
    const fs::path own = plan_.own_scene();
    switch (step.step) {
      case RunStep::kSynth:
        options_.synth();
        return;
      case RunStep::kPoses:
        find_cameras(own);
        return;
      case RunStep::kDepth:
        fill_depth(own_copy(), store_, *step.network, network_options());
        return;
      case RunStep::kClasses:
        fill_semantics(own_copy(), store_, *step.network, network_options());
        return;
      case RunStep::kMeasure:
        if (measure_into_run(scene(), plan_.run, plan_.config, context_)) folder_ = own;
        return;
      case RunStep::kRefine:
        refine_into_run(scene(), plan_.run, plan_.config, context_);
        folder_ = own;
        return;
      case RunStep::kComplete:
        complete(own);
        return;
      default:
        return;  // steps of training and after it
    }
  }

  void complete(const fs::path& own) {
    CompletedScene completed = complete_into_run(scene(), plan_.run, plan_.config, context_);
    if (completed.written) folder_ = own;
    camera_note_ = std::move(completed.camera_note);
  }

  const Scene& scene() {
    if (!opened_) opened_ = open_scene(folder_);
    return *opened_;
  }

  void find_cameras(const fs::path& own) const {
    ScenePhotosOptions poses = options_.photos;
    poses.overwrite = fs::exists(own);
    make_folders(plan_.run);
    const ScenePhotosReport report = run_poses(plan_.source.string(), own.string(), poses, store_);
    log_info("{} of {} photos placed by {}, {} points", report.placed, report.photos, report.method, report.points);
  }

  /// RUN/scene, first made as a copy of the source where it is not there.
  const fs::path& own_copy() {
    const fs::path own = plan_.own_scene();
    if (folder_ == own) return folder_;
    write_scene_copy(folder_, own, true);
    folder_ = own;
    return folder_;
  }

  ScenePriorsOptions network_options() const {
    ScenePriorsOptions fill;
    fill.precision = options_.precision;
    fill.make_device = options_.make_device;
    fill.drop_percent = options_.photos.drop_percent;
    fill.memory_limit = request_.train.memory_limit;
    fill.threads = context_.global.threads;
    fill.progress = context_.progress();
    return fill;
  }

  const RunPlan& plan_;
  const RunRequest& request_;
  const PlanExecutionOptions& options_;
  const ModelStore& store_;
  const CommandContext& context_;
  std::string camera_note_;
  fs::path folder_;              ///< of the scene as the steps so far left it
  std::optional<Scene> opened_;  ///< of folder_; empty until a step needs it
};

}  // namespace

RunMetrics execute_plan(const RunPlan& plan, const RunRequest& request, const PlanExecutionOptions& options,
                        const ModelStore& store, const CommandContext& context) {
  TrainOptions train = request.train;
  ScenePreparation preparation(plan, request, options, store, context);
  train.labels_unwanted = request.priors.semantics.none();
  train.scene = preparation.prepare();
  train.camera_note = preparation.camera_note();
  return run_pipeline(plan, train, context, options.make_fusion_device);
}

}  // namespace aligngs
