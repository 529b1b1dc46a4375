// Runs of other rooms than the first one: their views may bear the same names.
#pragma once

#include <vector>

#include "cli/report/run_scores.h"

namespace aligngs {

/// Sets RunScores::other_room. Runs of one scene show one room. Others are compared by the photos of test views that
/// both have, in renders/test/gt or in the scene. The size is one where cuts and lenses make no difference. Runs without
/// such photos pass.
void mark_other_rooms(std::vector<RunScores>& runs);

}  // namespace aligngs
