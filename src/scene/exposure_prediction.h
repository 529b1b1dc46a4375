// How photos would be exposed that were not taken: a camera's automatic exposure follows what it sees.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace aligngs {

/// One per view: View::log_gain of training views. Gains of test views follow from the training views nearest in place
/// and direction. Zeros for test views if neighbours do not predict gains (exposures set by chance). The check predicts
/// each training view's gain from the rest: its error must fall by half. The test photos are not looked at.
std::vector<Vec3f> predict_log_gains(const Scene& scene);

}  // namespace aligngs
