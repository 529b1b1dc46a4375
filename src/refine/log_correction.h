// A dense correction of prior depth from places where it is known, some of them well and some not.
#pragma once

#include "core/image.h"

namespace aligngs {

struct LogCorrectionSettings {
  double smoothness = 0.5;    ///< weight of the difference between neighbouring pixels, where a sure pixel weighs 1
  double across_edge = 0.01;  ///< share of it where the prior depth jumps: surfaces are bent one by one
  double depth_jump = 0.03;   ///< relative difference that is a jump
  /// steps of the photo's luma of this size divide surfaces by half; 0: the photo is not looked at
  double luma_edge = 0.04;
  /// weight of no correction: what nothing is known about stays, some 100 pixels from what is
  double none = 1e-4;
};

/// The field g (H x W, log units) that minimises sum w (g - given)^2 + smoothness sum (g - g')^2 + none sum g^2 over
/// the pixels with prior depth; 0 elsewhere. `given`, `weight` (>= 0) and `luma` are H x W; without luma its edges mean
/// nothing.
ImageF spread_log_correction(const ImageF& depth, const ImageF& given, const ImageF& weight,
                             const LogCorrectionSettings& settings, const ImageF& luma = {});

}  // namespace aligngs
