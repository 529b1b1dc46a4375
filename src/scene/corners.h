// Corners of a photo: places that can be found again in another one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"

namespace aligngs {

struct CornerSettings {
  int per_view = 600;     ///< strongest of a photo, at most
  int spacing = 5;        ///< pixels between corners
  double quality = 0.01;  ///< of the photo's strongest corner
};

struct Corner {
  float strength = 0;  ///< smaller eigenvalue of the structure tensor
  int x = 0, y = 0;    ///< pixel; its centre is (x + 0.5, y + 0.5)
};

/// Pixels of a photo over those of 320 x 240, for which numbers of corners are chosen.
double relative_size(const ImageF& luma);

/// Luma in [0, 1], H x W x 1, of an sRGB image.
ImageF luma_of(const ImageF& color);

/// Shi and Tomasi 1994, strongest first, none nearer to another than the spacing; plain walls have none. `mask` (H x W
/// x 1, 0 = do not use) may be empty.
std::vector<Corner> find_corners(const ImageF& luma, const ImageF& mask, const CornerSettings& settings);

}  // namespace aligngs
