// Whether the depth of one view is confirmed or contradicted by the others.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "mesh/fusion_frame.h"

namespace aligngs {

enum class PixelSupport : uint8_t {
  kNone,          ///< no depth here
  kConfirmed,     ///< another view agrees
  kSingleView,    ///< no other view says anything about this surface (out of its image, or hidden)
  kContradicted,  ///< another view looks through this surface, and none agrees
};

struct ConsistencyOptions {
  double depth_tolerance = 0;    ///< relative; who fuses chooses it, as by mesh.consistency
  double pixel_tolerance = 1.0;  ///< pixels, there and back
  double see_through = 0.04;     ///< relative: the other view must see this much farther to contradict
};

/// Usable depth of each frame: 0 where there is none, where alpha is below `min_alpha` and beyond `max_depth`
/// (scene units; 0: no limit).
ImageF usable_depth(const FusionFrame& frame, double min_alpha, double max_depth);

/// Support of every pixel of view `index`. A pixel is confirmed when its point, taken to another view, meets a depth
/// that agrees to the relative tolerance. The point of that depth must come back to within the pixel tolerance.
/// `depths` are usable_depth() of `frames`; interpolated frames neither confirm nor contradict.
Image<uint8_t> pixel_support(const std::vector<FusionFrame>& frames, const std::vector<ImageF>& depths, size_t index,
                             ThreadPool& pool, const ConsistencyOptions& options);

/// Median |difference| in scene units between the depth that one view predicts for another and the depth there. Only
/// pairs that differ by less than 10 % count (else one hides the other). 0 when no two views overlap.
double two_view_residual(const std::vector<FusionFrame>& frames, const std::vector<ImageF>& depths, ThreadPool& pool);

}  // namespace aligngs
