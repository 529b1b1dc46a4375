// Photographs in the sizes that VGGT was trained on, as its loader makes them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "nn/preprocess/image_placement.h"
#include "nn/preprocess/normalised_image.h"

namespace aligngs::nn {

inline constexpr int kVggtSize = 518;  ///< pixels of the longer side (crop: of the width)
inline constexpr int kVggtPatch = 14;  ///< sides are multiples of it

enum class VggtFit {
  kCrop,  ///< width 518; a height above 518 is cut in the middle
  kPad    ///< longer side 518, padded with white to 518 x 518
};

using VggtPlacement = ImagePlacement;

/// RGB of 8 bits. Grey and RGBA images are accepted (alpha over white).
Image<uint8_t> vggt_image(const Image<uint8_t>& photo, VggtFit fit, VggtPlacement* placement = nullptr);

/// Its size for a photo of so many pixels.
ImageSize vggt_image_size(int width, int height, VggtFit fit);

/// Pads all with white to the largest height and width, centred.
void vggt_common_size(std::vector<Image<uint8_t>>& images, std::vector<VggtPlacement>* placements = nullptr);

struct VggtSquare {
  Image<uint8_t> image;
  float x1, y1, x2, y2;  ///< the photograph in the new frame, pixels
  float width, height;   ///< of the photograph
};
/// Centred on a black square, resized to target x target.
VggtSquare vggt_square_image(const Image<uint8_t>& photo, int target);

}  // namespace aligngs::nn
