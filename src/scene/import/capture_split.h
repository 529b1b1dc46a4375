// The frames of a capture that train, and those that are held out.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "scene/import/capture.h"
#include "scene/import/import_capture.h"

namespace aligngs {

/// Indices into Capture::frames. No frame is in both.
struct CaptureSplit {
  std::vector<int> train, test;
};

/// As the options ask, else as the capture has it. Without either, many frames are chosen by coverage, and few frames
/// all train. Frames of test_names never train, unless train_names has them as well. A number of test views alone is
/// held out of few frames. A name that is twice in a list counts once. Error{kUsage} for options that contradict each
/// other. Error{kBadInput} for a name that no frame has. The same where an option or list leaves fewer than
/// kFewestTrainingViews of more frames for training: it is named. A single frame trains alone.
CaptureSplit split_capture(const Capture& capture, const ImportOptions& options, ThreadPool& pool);

}  // namespace aligngs
