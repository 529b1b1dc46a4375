#include "pipeline/run_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/shell_word.h"
#include "io/colmap.h"
#include "pipeline/room_memory.h"
#include "pipeline/run_source.h"
#include "pipeline/step_forecast.h"
#include "priors/given_poses.h"
#include "priors/scene_priors.h"
#include "priors/teacher_list.h"
#include "priors/video_frames.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct NamedStep {
  RunStep step;
  const char* name;
};
constexpr std::array<NamedStep, 13> kSteps = {{{RunStep::kSynth, "synth"},
                                               {RunStep::kPoses, "poses"},
                                               {RunStep::kDepth, "depth"},
                                               {RunStep::kClasses, "classes"},
                                               {RunStep::kMeasure, "measure"},
                                               {RunStep::kRefine, "refine"},
                                               {RunStep::kComplete, "complete"},
                                               {RunStep::kTrain, "train"},
                                               {RunStep::kRender, "render"},
                                               {RunStep::kMesh, "mesh"},
                                               {RunStep::kEvaluate, "evaluate"},
                                               {RunStep::kReport, "report"},
                                               {RunStep::kRoom, "room"}}};

RunMode mode_of_request(const TrainOptions& train) {
  return train.resume ? RunMode::kResume : train.overwrite ? RunMode::kOverwrite : RunMode::kNew;
}

/// Photos have a way without networks, which is worth a line.
[[noreturn]] void throw_with_way_without_networks(const Error& error, const RunRequest& request) {
  Error::Details details = error.details();
  const std::string run =
      fmt::format("aligngs run {} -o {}", quote_word(request.source.string()), quote_word(request.train.run.string()));
  if (has_given_cameras(request.source))
    details.remedy += "\n  or use the cameras that lie beside the photos: " + run + " --method given";
  details.remedy +=
      fmt::format("\n  or go without networks (no class labels): {} --method colmap --semantics none", run);
  throw Error(details);
}

PlannedStep planned(RunStep step, std::string reason) { return {.step = step, .reason = std::move(reason)}; }

PlannedStep left_out(RunStep step, std::string reason) {
  return {.step = step, .outlook = Outlook::kLeftOut, .reason = std::move(reason)};
}

PlannedStep decided(RunStep step, const Decision& decision) {
  return {.step = step,
          .outlook = decision.wanted ? Outlook::kPlanned : Outlook::kLeftOut,
          .reason = decision.reason,
          .notice = decision.notice,
          .network = decision.network,
          .terms = decision.terms};
}

/// A wanted step that the scene, which an earlier step makes, can still leave out.
PlannedStep expected(RunStep step, const Decision& allowed, const char* condition) {
  PlannedStep made = decided(step, allowed);
  if (!allowed.wanted) return made;
  made.outlook = Outlook::kExpected;
  made.reason += std::string(", ") + condition;
  return made;
}

Decision decide(RunStep step, const Scene& scene, const RunRequest& request, const RunPlan& plan,
                const ModelStore& store) {
  CameraRequest cameras = request.cameras;
  if (plan.from_photos()) {
    cameras.method = plan.cameras.method;
    cameras.model = plan.cameras.model;
  }
  switch (step) {
    case RunStep::kDepth:
      return decide_depth(scene, request.priors, cameras, plan.config, store);
    case RunStep::kClasses:
      return decide_classes(scene, request.priors, store);
    case RunStep::kMeasure:
      return decide_measure(scene, plan.config);
    case RunStep::kRefine:
      return decide_refine(scene, plan.config);
    case RunStep::kComplete:
      return decide_complete(scene, plan.config);
    default:
      return {.wanted = true, .reason = "every run has it"};
  }
}

/// Weights that were asked for by name must be there before anything else starts.
void require_named_weights(const RunRequest& request, const RunPlan& plan, const ModelStore& store) {
  try {
    if (is_camera_network_method(plan.cameras.method)) store.require(published_model(plan.cameras.model));
    const PriorRequest& priors = request.priors;
    for (const PriorChoice* prior : {&priors.semantics, &priors.depth}) {
      if (prior->network) store.require(published_model(prior->network->model));
    }
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kWeights || !plan.from_photos()) throw;
    throw_with_way_without_networks(error, request);
  }
}

CameraChoice cameras_of_photos(const RunRequest& request, const ModelStore& store) {
  try {
    return choose_cameras(request.cameras, store);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kWeights) throw;
    throw_with_way_without_networks(error, request);
  }
}

void add_left_out(RunPlan& plan, const std::string& reason) {
  for (const RunStep step :
       {RunStep::kPoses, RunStep::kDepth, RunStep::kClasses, RunStep::kMeasure, RunStep::kRefine, RunStep::kComplete})
    plan.steps.push_back(left_out(step, reason));
}

/// The work before training on a scene that is there.
void plan_scene(const RunRequest& request, const ModelStore& store, RunPlan& plan) {
  const Scene scene = open_scene(request.source);
  const auto add = [&](RunStep step) -> PlannedStep& {
    plan.steps.push_back(decided(step, decide(step, scene, request, plan, store)));
    return plan.steps.back();
  };
  plan.steps.push_back(left_out(RunStep::kPoses, "the scene has cameras"));
  const bool depth = add(RunStep::kDepth).outlook == Outlook::kPlanned;
  add(RunStep::kClasses);
  if (depth) {
    plan.steps.push_back(left_out(RunStep::kMeasure, "depth comes from a network"));
    plan.steps.push_back(
        expected(RunStep::kRefine, may_refine(plan.config), "if the network's depth is in the units of the scene"));
    plan.steps.push_back(left_out(RunStep::kComplete, "the depth is neither of a sensor nor given"));
    return;
  }
  if (add(RunStep::kMeasure).outlook == Outlook::kPlanned) {
    plan.steps.push_back(left_out(RunStep::kRefine, "depth is measured with these very cameras"));
    plan.steps.push_back(left_out(RunStep::kComplete, "measuring depth does such work itself"));
    return;
  }
  if (add(RunStep::kRefine).outlook == Outlook::kPlanned)
    plan.steps.push_back(left_out(RunStep::kComplete, "refining does such work itself"));
  else
    add(RunStep::kComplete);
}

/// The work before training on photos, whose scene is still to be made.
void plan_photos(const RunRequest& request, const ModelStore& store, RunPlan& plan) {
  const CameraChoice& cameras = plan.cameras;
  PlannedStep poses = planned(RunStep::kPoses, cameras.reason);
  if (!cameras.model.empty()) poses.network = &published_model(cameras.model);
  if (cameras.chosen) poses.terms = terms_of_choice(*poses.network, "cameras");
  plan.steps.push_back(poses);

  CameraRequest found = request.cameras;
  found.method = cameras.method;
  found.model = cameras.model;
  const bool network = poses.network != nullptr, given = cameras.method == PosesMethod::kGiven;
  const Decision measure = may_measure(plan.config);
  const Decision by_network = decide_depth(measure.wanted, request.priors, found, store);
  if (network)
    plan.steps.push_back(left_out(RunStep::kDepth, "the network for cameras brings depth"));
  else if (given)
    plan.steps.push_back(expected(RunStep::kDepth, by_network, "if none comes with the cameras"));
  else
    plan.steps.push_back(decided(RunStep::kDepth, by_network));
  const bool depth = plan.steps.back().outlook == Outlook::kPlanned;
  plan.steps.push_back(decided(RunStep::kClasses, decide_classes(request.priors, store)));
  if (network || depth)
    plan.steps.push_back(left_out(RunStep::kMeasure, "depth comes from a network"));
  else
    plan.steps.push_back(expected(RunStep::kMeasure, measure, "if the cameras come with points"));
  plan.steps.push_back(
      expected(RunStep::kRefine, may_refine(plan.config), "if the scene has prior depth in its own units"));
  if (given)
    plan.steps.push_back(expected(RunStep::kComplete, may_complete(plan.config), "if it comes with the cameras"));
  else
    plan.steps.push_back(left_out(RunStep::kComplete, "the depth is neither of a sensor nor given"));
}

std::string training_reason(const ResolvedRun& resolved) {
  const int64_t end = resolved.config.train.iterations;
  if (!resolved.exists || !resolved.record)
    return fmt::format("{} iterations with preset {}", end, word_of(resolved.config.train.preset));
  if (resolved.finished)
    return fmt::format("the training has reached its {} iterations", resolved.record->train.iterations);
  return fmt::format("the training goes on to {} iterations from its newest checkpoint", end);
}

/// Training and what follows from it.
void plan_training(const ResolvedRun& resolved, RunPlan& plan) {
  PlannedStep training = planned(RunStep::kTrain, training_reason(resolved));
  if (resolved.finished) training.outlook = Outlook::kLeftOut;
  plan.steps.push_back(training);
  plan.steps.push_back(planned(RunStep::kRender, "pictures of the test views"));
  plan.steps.push_back(planned(RunStep::kMesh, "the rendered depth of all views is fused to a mesh"));
  plan.steps.push_back(planned(RunStep::kEvaluate, "figures for metrics.json"));
  plan.steps.push_back(planned(RunStep::kReport, "report.html and overview.jpg"));
  plan.steps.push_back(planned(RunStep::kRoom, "room.json; openings and furniture need class labels"));
}

/// The scene that is trained. A step before training writes RUN/scene.
fs::path trained_scene(const RunPlan& plan, bool has_own) {
  if (has_own) return plan.own_scene();
  const bool made = std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlannedStep& s) {
    return s.step < RunStep::kTrain && s.outlook == Outlook::kPlanned;
  });
  return made ? plan.own_scene() : plan.source;
}

}  // namespace

const char* step_name(RunStep step) {
  for (const NamedStep& named : kSteps) {
    if (named.step == step) return named.name;
  }
  return "unknown";
}

const char* outlook_name(Outlook outlook) {
  return outlook == Outlook::kPlanned ? "planned" : outlook == Outlook::kExpected ? "expected" : "left out";
}

bool RunPlan::has(RunStep wanted) const { return step(wanted).outlook != Outlook::kLeftOut; }

const PlannedStep& RunPlan::step(RunStep wanted) const {
  static const PlannedStep absent{.outlook = Outlook::kLeftOut};
  const auto found = std::find_if(steps.begin(), steps.end(), [&](const PlannedStep& s) { return s.step == wanted; });
  return found == steps.end() ? absent : *found;
}

uint64_t RunPlan::memory_bytes() const {
  uint64_t most = 0;
  for (const PlannedStep& step : steps) {
    if (step.outlook != Outlook::kLeftOut) most = std::max(most, step.memory_bytes.value_or(0));
  }
  return most;
}

std::vector<std::string> RunPlan::steps_of_unknown_time() const {
  std::vector<std::string> names;
  for (const PlannedStep& step : steps) {
    if (step.outlook != Outlook::kLeftOut && !step.seconds) names.emplace_back(step_name(step.step));
  }
  return names;
}

PlannedStep settled_step(const PlannedStep& expected, const Scene& scene, const RunRequest& request,
                         const RunPlan& plan, const ModelStore& store) {
  return decided(expected.step, decide(expected.step, scene, request, plan, store));
}

RunPlan plan_run(const RunRequest& request, const ModelStore& store) {
  const TrainOptions& train = request.train;
  const RunFolder folder(train.run);
  RunPlan plan;
  plan.source = request.source;
  plan.run = train.run;
  const bool photos = needs_cameras(request);
  folder.check(mode_of_request(train));
  plan.begun = train.resume && fs::exists(folder.record());
  require_source_apart(request, plan.begun);
  const ResolvedRun resolved = resolve_run(train);
  plan.config = resolved.config;
  const fs::path own = plan.own_scene();
  const bool keeps_scene =
      plan.begun && (photos ? may_hold_colmap_model(own) : resolved.record->scene == own.filename());
  std::vector<NetworkInput> sizes;
  if (photos && !keeps_scene) {
    plan.cameras = cameras_of_photos(request, store);
    require_named_weights(request, plan, store);
    ScenePhotosOptions options = request.photos;
    options.method = plan.cameras.method;
    options.model = plan.cameras.model;
    options.cameras = request.cameras.cameras;
    options.overwrite = fs::exists(own);
    check_photos(plan.source, own, store, options);
    plan_photos(request, store, plan);
    if (fs::is_directory(plan.source)) sizes = sizes_of_photos(plan.source, options.max_side);
  } else if (plan.begun) {
    add_left_out(plan, "the run has begun, with its scene as it is");
    sizes = sizes_of_photos(keeps_scene ? own : plan.source);
  } else {
    require_named_weights(request, plan, store);
    plan_scene(request, store, plan);
    sizes = sizes_of_photos(plan.source);
  }
  plan_training(resolved, plan);
  plan.scene = trained_scene(plan, photos || keeps_scene);
  forecast_steps(request, store, sizes, plan);
  return plan;
}

RunPlan plan_demo(const TrainOptions& train, const std::string& room, uint64_t pixels) {
  const RunFolder folder(train.run);
  folder.check(mode_of_request(train));
  const ResolvedRun resolved = resolve_run(train);
  RunPlan plan;
  plan.run = train.run;
  plan.scene = plan.source = plan.own_scene();
  plan.config = resolved.config;
  plan.begun = train.resume && fs::exists(folder.record());
  if (train.resume && fs::exists(plan.scene))
    plan.steps.push_back(left_out(RunStep::kSynth, "the synthetic scene is there"));
  else
    plan.steps.push_back(planned(RunStep::kSynth, fmt::format("a synthetic {} with simulated priors", room)));
  if (plan.begun)
    plan.steps.push_back(left_out(RunStep::kRefine, "the run has begun, with its scene as it is"));
  else
    plan.steps.push_back(expected(RunStep::kRefine, may_refine(plan.config), "if the simulated depth allows it"));
  plan_training(resolved, plan);
  forecast_training(train, pixels, plan);
  return plan;
}

}  // namespace aligngs
