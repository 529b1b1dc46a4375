// Sources that a run can be made from.
#pragma once

#include <filesystem>

#include "pipeline/run_plan.h"

namespace aligngs {

/// Whether cameras must be found or matched first: photos, a video, or given cameras. Error{kBadInput} for anything that
/// is neither that nor a scene folder, with the command that reads it where there is one.
bool needs_cameras(const RunRequest& request);

/// Error{kUsage} where the source is the scene that the run keeps for itself. The same where the run folder would write
/// into the source or over it. `begun`: the run goes on.
void require_source_apart(const RunRequest& request, bool begun);

}  // namespace aligngs
