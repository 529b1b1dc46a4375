// Depth of a sensor without the pixels that it mixes, and with less confidence where it tends to err.
#pragma once

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

struct SensorDepthSettings {
  /// Cosine of the angle between a ray and the flattest surface that a sensor measures. Steeper steps from a pixel to
  /// both of its neighbours in a row or column are no surface: light of two surfaces is mixed there.
  double flattest = 0.2;
  double glancing = 0.35;  ///< the same cosine, below which a pixel is doubtful
  int span = 4;            ///< pixels to either side over which the slope of a surface is taken: noise averages out
  double dark = 0.2;       ///< luma (sRGB) of a pixel that returns too little light: 0.035 of white in linear light
  double concave = 0.35;   ///< sine of the angle at which a surface rises towards a pixel: light comes over it, too
  double doubtful_share = 0.5;  ///< factor of the confidence of doubtful pixels
};

struct SensorDepth {
  ImageF depth;                    ///< H x W: as measured, 0 at mixed pixels
  ImageF confidence;               ///< H x W: as given, or 1; less at doubtful pixels, 0 without depth
  double mixed = 0, doubtful = 0;  ///< shares of the pixels with depth
};

/// `camera`, `luma` (H x W in [0, 1]) and `confidence` (null: alike everywhere) have the size of `depth`; 0 = none.
SensorDepth clean_sensor_depth(const Camera& camera, const ImageF& depth, const ImageF* confidence, const ImageF& luma,
                               const SensorDepthSettings& settings);

}  // namespace aligngs
