// Chooses few views out of many: sharp ones that together see much of the scene, most of it more than once.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "scene/import/capture.h"

namespace aligngs {

struct ViewSelectionOptions {
  int count = 20;                 ///< views to choose
  double blurry_share = 1.0 / 3;  ///< this share of the frames, the blurriest among their neighbours, is not considered
  int max_candidates = 400;       ///< long captures are thinned to this many sharp frames first
};

/// Indices into capture.frames, in capture order. Greedy: each step adds the frame that gains most. A surface sample
/// counts 1 when first seen, 1/2 the second time, 1/4 the third (reconstruction needs two views). A second view counts
/// only if its direction differs by 2 degrees or more. Samples come from the frames' depth when there is any, else from
/// the cloud, else from fixed depths along a coarse grid of rays. Deterministic.
std::vector<int> select_views(const Capture& capture, const ViewSelectionOptions& options, ThreadPool& pool);

/// Every n-th frame: 0, n, 2n, ...
std::vector<int> select_stride(const Capture& capture, int stride);

/// Test views for a given training set: up to `count` sharp frames, spread over the capture. None is adjacent to a
/// training frame if possible.
std::vector<int> select_test_views(const Capture& capture, const std::vector<int>& train, int count, ThreadPool& pool);

}  // namespace aligngs
