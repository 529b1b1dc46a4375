// A network's depth, once cameras, stereo and labelled planes have corrected it, laid on planes of what was measured.
#pragma once

#include <vector>

#include "refine/bare_planes.h"

namespace aligngs {

/// Log factors on the depth of each photo, at its size.
struct BarePlaneFactors {
  std::vector<ImageF> log_factors;
  BarePlaneReport report;
};

/// `photos`: refined cameras, luma and corrected depth. `labels`, `certainty`: one map per photo, which may be empty.
/// Certainty is 0 where nothing was measured, and counts as 1 above 1. Depth without a value gets a factor of 0.
/// Deterministic for any number of threads.
BarePlaneFactors bare_plane_factors(const std::vector<MatchView>& photos, const std::vector<Image<uint16_t>>& labels,
                                    const std::vector<ImageF>& certainty, const BarePlaneSettings& settings,
                                    const StereoSettings& stereo, const KnownSurfaces& known, ThreadPool& pool);

}  // namespace aligngs
