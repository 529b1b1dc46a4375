// A smooth choice of one hypothesis per pixel (Hirschmueller 2008, semi-global matching).
#pragma once

#include "core/image.h"
#include "refine/stereo_sweep.h"

namespace aligngs {

struct SemiGlobalSettings {
  float small_step = 0.04f;  ///< cost of a neighbour with the next hypothesis
  float large_step = 0.4f;   ///< cost of one with any other
  float across_edge = 0.1f;  ///< both are multiplied by it where the prior depth jumps
  double depth_jump = 0.03;  ///< relative difference that is a jump
  /// the large step is divided by 1 + (step of the photo's luma / this); 0: the photo is not looked at
  double luma_edge = 0.04;
};

/// Costs summed over eight directions; the argument's are replaced. `depth` is the prior depth, H x W,
/// `luma` the photo; without it luma_edge means nothing.
void aggregate_costs(CostVolume& volume, const ImageF& depth, const SemiGlobalSettings& settings,
                     const ImageF& luma = {});

}  // namespace aligngs
