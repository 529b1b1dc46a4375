// How photos would be exposed that were not taken: a camera's automatic exposure follows what it sees.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace aligngs {

/// One per view: View::log_gain of training views, and for test views what the training views nearest in place and direction say.
/// Zeros for test views where neighbours do not tell: when the gains of the training views themselves, each predicted from the
/// rest, are not known better for it by half (exposures set by chance). The test photos are not looked at.
std::vector<Vec3f> predict_log_gains(const Scene& scene);

}  // namespace aligngs
