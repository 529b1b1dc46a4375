// Edits and selections against the truth of a synthetic room: `aligngs edit --measure` and `--truth`.
#pragma once

#include "cli/command.h"
#include "cli/edit_options.h"

namespace aligngs {

/// The selection of --select, or every object without one, against the true mesh of the scene. Error{kBadInput} when
/// the scene has no true mesh or the run has none.
void measure_selection(const CommandContext& context, EditSession& session, const EditOptions& options);

/// A run that `aligngs edit -o` wrote against the scene's truth without the object.
void measure_removal(const CommandContext& context, const EditOptions& options);

}  // namespace aligngs
