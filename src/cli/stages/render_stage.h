// Pictures of a run's views: renders/{test,train}/{rgb,gt,error,depth,normal,label}/<view>.png.
#pragma once

#include <vector>

#include "cli/stages/loaded_run.h"
#include "core/progress.h"

namespace aligngs {

enum class RenderedSplit {
  kPictured,  ///< pictured_views(): test views, or a few training views where there are none
  kTest,
  kTrain,
  kAll
};

struct RenderStageOptions {
  RenderedSplit split = RenderedSplit::kPictured;
  ProgressStyle progress;
};

/// rgb, gt and error are colour. depth is a colour ramp, with the values beside it in depth16/ (uint16, thousandths of
/// a scene unit, 0 = none). normal is camera-frame. label uses the class colours. label_id/ (uint8, 255 = none) has the
/// class numbers if there are fewer than 255 classes. Returns the number of views.
size_t render_views(LoadedRun& run, const RenderStageOptions& options);

}  // namespace aligngs
