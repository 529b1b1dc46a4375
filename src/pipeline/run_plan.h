// A run as a plan: its steps, with the reason for each and what it is expected to take, before anything is done.
// `run`, `demo` and `batch` carry plans out; `run --dry-run` prints one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "nn/compute.h"
#include "pipeline/scene_decisions.h"
#include "priors/scene_from_photos.h"
#include "train/train_run.h"

namespace aligngs {

/// In the order in which they are done.
enum class RunStep {
  kSynth,     ///< a synthetic scene, of `demo`
  kPoses,     ///< a scene with cameras, from photos
  kDepth,     ///< prior depth by a network
  kClasses,   ///< class labels by a network
  kMeasure,   ///< prior depth measured in the photos
  kRefine,    ///< cameras and prior depth corrected
  kComplete,  ///< exposures measured and holes of the depth filled
  kTrain,
  kRender,
  kMesh,
  kEvaluate,
  kReport,
  kRoom
};

/// "poses", "depth", ... as --dry-run prints them.
const char* step_name(RunStep step);

enum class Outlook {
  kPlanned,
  kExpected,  ///< what an earlier step finds decides
  kLeftOut
};
const char* outlook_name(Outlook outlook);

struct PlannedStep {
  RunStep step = RunStep::kTrain;
  Outlook outlook = Outlook::kPlanned;
  std::string reason = {};                    ///< one sentence without a final stop
  Notice notice = Notice::kNone;              ///< of a step that is left out
  const PublishedModel* network = nullptr;    ///< that does it; null: none
  std::string terms = {};                     ///< of a network that nobody named
  std::optional<double> seconds = {};         ///< empty: unknown
  std::optional<uint64_t> memory_bytes = {};  ///< at its peak; empty: unknown
};

struct RunRequest {
  std::filesystem::path source;  ///< a folder of photos, a video, or a scene folder
  TrainOptions train;            ///< run folder, settings, memory; the scene follows from the source
  CameraRequest cameras;
  ScenePhotosOptions photos;  ///< of photos; method, model and cameras follow from `cameras`
  PriorRequest priors;
};

struct RunPlan {
  std::filesystem::path source, run;
  std::filesystem::path scene;  ///< that is trained, as far as it is decided; RUN/scene wherever a step writes it
  bool begun = false;           ///< its training goes on
  CameraChoice cameras;         ///< of photos; no method otherwise
  size_t photos = 0;            ///< of the source, as far as they can be counted; 0: unknown
  TrainConfig config;
  std::vector<PlannedStep> steps;  ///< those left out as well

  bool has(RunStep step) const;
  const PlannedStep& step(RunStep step) const;
  bool from_photos() const { return cameras.method != PosesMethod::kAuto; }
  /// The scene that this run keeps for itself.
  std::filesystem::path own_scene() const { return run / "scene"; }
  /// The largest peak among the steps that are not left out, as far as it is known; 0: nothing is known.
  uint64_t memory_bytes() const;
  /// Names of the steps that are not left out and whose time is unknown.
  std::vector<std::string> steps_of_unknown_time() const;
};

/// The steps of `aligngs run`. Reads headers and changes nothing. Errors are those of a run before its first step:
/// kUsage and kBadInput for source and run folder, kWeights for networks, kFailed for missing programs.
RunPlan plan_run(const RunRequest& request, const ModelStore& store);

/// The steps of `aligngs demo`. `room`: what is made; `pixels`: of its views together.
RunPlan plan_demo(const TrainOptions& train, const std::string& room, uint64_t pixels);

/// A step that an earlier one decides (Outlook::kExpected), now that the scene is there: planned or left out.
PlannedStep settled_step(const PlannedStep& expected, const Scene& scene, const RunRequest& request,
                         const RunPlan& plan, const ModelStore& store);

}  // namespace aligngs
