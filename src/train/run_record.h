// run.json: what a run is, its stage, and why it ended.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/choice_words.h"

namespace aligngs {

enum class RunStatus {
  kUnknown,  ///< the file has none, or a word that this program does not know
  kRunning,
  kPaused,
  kStopped,  ///< by a signal or the page; can be resumed
  kFailed,
  kDone
};
template <>
inline constexpr std::array<ChoiceWord<RunStatus>, 6> kChoiceWords<RunStatus> = {{{RunStatus::kUnknown, ""},
                                                                                  {RunStatus::kRunning, "running"},
                                                                                  {RunStatus::kPaused, "paused"},
                                                                                  {RunStatus::kStopped, "stopped"},
                                                                                  {RunStatus::kFailed, "failed"},
                                                                                  {RunStatus::kDone, "done"}}};

enum class RunStage {
  kUnknown,  ///< the file has none, or a word that this program does not know
  kTrain,
  kRender,
  kMesh,
  kMeasure,
  kReport,
  kRoom,
  kDone,
  kEdit
};
template <>
inline constexpr std::array<ChoiceWord<RunStage>, 9> kChoiceWords<RunStage> = {{{RunStage::kUnknown, ""},
                                                                                {RunStage::kTrain, "train"},
                                                                                {RunStage::kRender, "render"},
                                                                                {RunStage::kMesh, "mesh"},
                                                                                {RunStage::kMeasure, "measure"},
                                                                                {RunStage::kReport, "report"},
                                                                                {RunStage::kRoom, "room"},
                                                                                {RunStage::kDone, "done"},
                                                                                {RunStage::kEdit, "edit"}}};

struct RunRecord {
  RunStatus status{};
  RunStage stage{};
  std::string command;  ///< the command line as typed
  std::string version;  ///< of the program
  std::string device;
  int64_t seed = 0;
  std::string started, updated, finished;  ///< UTC, ISO 8601; finished is empty until the end
  std::string trained;      ///< when training reached its last iteration and wrote its outputs; empty until then
  std::string reason;       ///< why it ended
  std::string scene;        ///< folder, relative to the run folder
  std::string fingerprint;  ///< scene_fingerprint
  std::vector<std::string> left_out;  ///< views of the scene that were not used: later stages leave them out as well
  /// scale of the prior depth, how it was laid on the scene, and its residual; empty without any
  std::string prior_depth;
  std::string cameras;  ///< how well a sensor's cameras agree with the photos; empty where that was not measured
  std::vector<std::string> warnings;  ///< e.g. priors that were missing
  struct Train {
    double seconds = 0;      ///< over all resumes
    int64_t iterations = 0;  ///< completed
    uint64_t gaussians = 0;
    double iterations_per_second = 0;
    uint64_t peak_memory_bytes = 0;
  } train;
};

/// Atomic; fields of the file that are not in the record (written by later stages) are kept.
void write_run_record(const std::filesystem::path& path, const RunRecord& record);
/// Whether a file is a record that this program wrote: false when it is absent, damaged or somebody else's run.json.
bool is_run_record(const std::filesystem::path& path);

/// Error{kBadInput} when it cannot be read.
RunRecord read_run_record(const std::filesystem::path& path);

std::string utc_now();  ///< "2026-11-21T00:13:21Z"

/// The scene folder of a run: `override_folder` when given, else run.json's path from the run folder.
std::filesystem::path scene_of_run(const std::filesystem::path& run_folder, const RunRecord& record,
                                   const std::filesystem::path& override_folder = {});
/// `scene` as it is written into run.json of `run_folder`.
std::string relative_scene_path(const std::filesystem::path& run_folder, const std::filesystem::path& scene);

}  // namespace aligngs
