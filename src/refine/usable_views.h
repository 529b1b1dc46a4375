// Photos whose damage shows only when they are decoded: left out of refinement, as training leaves them out.
#pragma once

#include <functional>

#include "scene/scene.h"

namespace aligngs {

/// Runs `load`, which reads files of the views in the lists of `scene`. When that fails with Error{kBadInput}, every
/// file of every view is decoded. Views with a fatal problem leave the lists with one warning each, and `load` runs
/// once more. Error{kBadInput}: the error of `load` when no view is at fault, or too few training views are left. A
/// scene without damage is decoded by `load` alone.
void load_usable_views(Scene& scene, const std::function<void()>& load);

}  // namespace aligngs
