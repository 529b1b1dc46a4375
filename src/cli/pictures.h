// Maps as pictures for people: depth, normals, labels, errors.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "scene/label_set.h"

namespace aligngs {

/// Near is warm, far is cold, no value is black. The range is [low, high] in scene units.
Image<uint8_t> depth_picture(const ImageF& depth, float low, float high);
/// The 2 % and 98 % quantiles of the positive values; (0, 1) when there are none.
struct DepthRange {
  float low = 0, high = 1;
};
DepthRange depth_range(const ImageF& depth);

/// Camera-frame normals: x right is red, y up is green, towards the camera is blue; (0,0,0) is black.
Image<uint8_t> normal_picture(const ImageF& normal);

/// The class colours; kNoLabel is black.
Image<uint8_t> label_picture(const Image<uint16_t>& labels, const LabelSet& set);

/// Mean absolute colour difference, black at 0, white at 0.25 and above (a quarter of the range is plainly wrong).
Image<uint8_t> error_picture(const ImageF& render, const ImageF& truth);

/// A smooth ramp from blue over green to red; t in [0, 1].
void ramp_color(float t, uint8_t rgb[3]);

}  // namespace aligngs
