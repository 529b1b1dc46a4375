// `--resume` on a run that has trained to its end.
#pragma once

#include <filesystem>

#include "train/run_record.h"
#include "train/train_run.h"

namespace aligngs {

/// Error{kBadInput}: the run has another scene than `scene`.
[[noreturn]] void refuse_other_scene(const std::filesystem::path& run, const std::filesystem::path& scene);

/// A finished run keeps its measurements: they are not made again with the scene of another room. Error{kBadInput} where
/// options.scene is given and is not the scene of the record.
void require_scene_of_finished(const TrainOptions& options, const RunRecord& record);

/// Figures of the finished training, from its record.
TrainResult result_of_finished(const RunRecord& record);

}  // namespace aligngs
