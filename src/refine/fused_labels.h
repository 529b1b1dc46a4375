// Labels that the photos agree on: a pixel's class is what most photos that show its place say of it.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "refine/plane_depth.h"

namespace aligngs {

struct LabelFusionSettings {
  /// relative difference of depths within which two photos show the same surface; above refined depth's error
  double agreement = 0.03;
};

/// One photo's labels after the vote.
struct FusedLabels {
  Image<uint16_t> labels;  ///< H x W, kNoLabel = none
  ImageF share;            ///< H x W, of the votes of a place that its label got, [0, 1]; 0 where it has none
};

/// Each photo that shows a pixel's place has one vote, the pixel's own among them. The photo's own class wins a tie
/// that it is part of, the smallest class any other. Pixels without depth keep their own; photos without labels stay
/// without and have no vote. Deterministic for any number of threads.
std::vector<FusedLabels> fuse_labels(const std::vector<PlaneView>& views, const LabelFusionSettings& settings,
                                     ThreadPool& pool);

}  // namespace aligngs
