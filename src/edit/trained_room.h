// The room that a training left, as edits begin with it.
#pragma once

#include "core/thread_pool.h"
#include "edit/apply_edit.h"
#include "train/opened_run.h"

namespace aligngs {

/// A finished training: scene.labels.ply, or scene.ply where there are no labels, in a tenth of the time that its
/// checkpoint takes. The room has then no semantic rows and no class probabilities. A training that was stopped: its
/// newest checkpoint. The cameras of `run` are placed. Errors as read_trained_state's; Error{kBadInput} for files that
/// are damaged or name other classes.
EditableRoom read_trained_room(const OpenedRun& run, ThreadPool& pool);

}  // namespace aligngs
