// Everything a run needs to continue exactly, in one safetensors file per checkpoint.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "scene/scene.h"
#include "train/plane_targets.h"
#include "train/pose_refinement.h"
#include "train/schedule.h"
#include "train/view_order.h"

namespace aligngs {

/// The state of a run between two iterations. Together with config.toml and the scene it determines every
/// later number, so writing one changes nothing and reading one continues bit for bit.
struct TrainingState {
  int64_t iteration = 0;       ///< completed iterations
  EngineState engine;          ///< parameters, moments, density statistics, running values
  bool trainable = true;       ///< false: of a finished run, without moments, statistics and running values
  bool in_scene_file = false;  ///< scene.ply beside the checkpoints has this model already
  ViewOrder::State order;
  std::array<uint64_t, 4> density_random{};  ///< of density control
  std::vector<float> depth_scales;           ///< a_v per training view (prior_alignment.h)
  std::vector<CameraMotion> motions;         ///< of the training cameras; empty: this run moves none
  PlaneTargets planes;                       ///< of the last fit (loss.plane_weight); empty: none yet
  int64_t non_finite_steps = 0;              ///< steps rolled back so far
  TrainingFacts facts;                       ///< read from a file: those of the start alone
  double psnr_average = 0;                   ///< running mean shown as progress, dB
  double seconds = 0;                        ///< training time so far, over all resumes
};

/// checkpoints/step_<iteration>.safetensors, atomic, with a checksum over its content; older ones beyond
/// `keep` are removed afterwards. A state that is not trainable is written without EngineState::arrays and with large
/// tensors compressed. If scene.ply beside `folder` has its model, the checkpoint refers to that file and keeps what the
/// file lacks: a fiftieth of the bytes. Write scene.ply first, and let nothing change it.
void write_checkpoint(const std::filesystem::path& folder, const TrainingState& state, const std::string& fingerprint,
                      int64_t keep);

enum class CheckpointParts {
  kAll,  ///< what a run needs to go on
  /// the same but moments and statistics, two thirds of the file: for those who only look at the scene
  kWithoutEngineArrays
};

/// Error{kBadInput} when the file is damaged, in whatever part, or belongs to another scene. The same when the scene.ply
/// that it refers to is gone or has changed.
TrainingState read_checkpoint(const std::filesystem::path& path, const std::string& fingerprint,
                              CheckpointParts parts = CheckpointParts::kAll);

/// The newest good checkpoint. A damaged one is reported as a warning and the one before is taken; nothing
/// when there is none. Error{kBadInput} when a good one belongs to another scene, or to another scene.ply.
std::optional<TrainingState> read_latest_checkpoint(const std::filesystem::path& folder, const std::string& fingerprint,
                                                    CheckpointParts parts = CheckpointParts::kAll);

/// Puts the cameras of the training views where the state of a run has them; the scene's own with no motions.
/// Error{kBadInput} when there are as many motions as another number of views has.
void apply_motions(const std::vector<CameraMotion>& motions, Scene& scene);

/// Whether training can go on from the newest checkpoint; true as well where there is none that can be read.
bool latest_checkpoint_is_trainable(const std::filesystem::path& folder);

/// Removes checkpoints of later iterations than the one a run goes on from: they are damaged, or of a run that
/// began anew.
void remove_checkpoints_beyond(const std::filesystem::path& folder, int64_t iteration);

/// Newest first; files that are being written or that are named otherwise are not listed.
std::vector<std::filesystem::path> list_checkpoints(const std::filesystem::path& folder);

}  // namespace aligngs
