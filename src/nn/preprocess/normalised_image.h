// Images as the networks take them: normalised by the statistics of ImageNet.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "nn/tensor.h"

namespace aligngs::nn {

/// (x - mean) / std of 8-bit RGB with mmseg's constants on 0..255.
FeatureMap normalised_image(const Image<uint8_t>& rgb);
/// (x - mean) / std of RGB in [0, 1].
void normalise_unit_image(FeatureMap& image);

/// mmseg's Resize with keep_ratio: the largest size within (long_side, short_side) of the aspect,
/// then, where multiple > 0, both sides stretched up to multiples of it. OpenCV's bilinear.
struct SegmentationResize {
  int long_side = 99999999;  ///< no limit
  int short_side = 512;
  int multiple = 0;
};
Image<uint8_t> segmentation_image(const Image<uint8_t>& rgb, const SegmentationResize& resize);

struct ImageSize {
  int width = 0, height = 0;
};
/// The size of segmentation_image() of a photo of width x height pixels.
ImageSize segmentation_size(int width, int height, const SegmentationResize& resize);

/// Zeros around a normalised image so that its sides are multiples, the smaller margin first.
FeatureMap centre_padded(const FeatureMap& image, int64_t multiple);

}  // namespace aligngs::nn
