// Photographs in the sizes that Depth Anything 3 was trained on, as its program prepares them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "nn/preprocess/image_placement.h"
#include "nn/preprocess/normalised_image.h"
#include "nn/tensor.h"

namespace aligngs::nn {

inline constexpr int kDa3Size = 504;  ///< pixels of the longest side
inline constexpr int kDa3Patch = 14;  ///< sides are multiples of it

/// The published methods: "upper_bound_resize" (the default), "lower_bound_resize", "upper_bound_crop",
/// "lower_bound_crop".
struct Da3ImageOptions {
  int size = kDa3Size;
  bool shortest_side = false;  ///< `size` is that of the shortest side
  bool cropped = false;        ///< sides become multiples of the patch by cutting, not by a second resize
};

/// RGB of 8 bits; grey and RGBA images are accepted (alpha is dropped, as published). Error{kBadInput} when a side
/// would become smaller than a patch.
Image<uint8_t> da3_image(const Image<uint8_t>& photo, const Da3ImageOptions& options = {},
                         ImagePlacement* placement = nullptr);

/// Its size for a photo of so many pixels; may be smaller than a patch.
ImageSize da3_image_size(int width, int height, const Da3ImageOptions& options = {});

/// Cuts all to the smallest height and the smallest width, in the middle.
void da3_common_size(std::vector<Image<uint8_t>>& images, std::vector<ImagePlacement>* placements = nullptr);

/// (x / 255 - mean) / std with ImageNet's constants: what the networks take.
FeatureMap da3_input(const Image<uint8_t>& image);

}  // namespace aligngs::nn
