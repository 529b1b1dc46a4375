// The room that a training left, as edits begin with it.
#pragma once

#include <filesystem>

#include "core/thread_pool.h"
#include "edit/apply_edit.h"
#include "scene/scene.h"
#include "train/config.h"
#include "train/run_record.h"

namespace aligngs {

struct TrainedRoom {
  RunRecord record;
  TrainConfig config;
  Scene scene;  ///< training cameras where training left them
  EditableRoom room;
};

/// A finished training: scene.labels.ply, or scene.ply where there are no labels, in a tenth of the time that its
/// checkpoint takes. The room has then no semantic rows and no class probabilities. A training that was stopped: its
/// newest
/// checkpoint. `scene` may be empty (read_run_without_state). Errors as read_trained_run's.
TrainedRoom read_trained_room(const std::filesystem::path& run, const std::filesystem::path& scene, ThreadPool& pool);

}  // namespace aligngs
