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
/// held out of few frames. Error{kUsage} for options that contradict each other; Error{kBadInput} for a name that no
/// frame has, and when no frame is left to train on.
CaptureSplit split_capture(const Capture& capture, const ImportOptions& options, ThreadPool& pool);

}  // namespace aligngs
