// Regions that the queries of a simulated segmentation network see of a view, and their soft masks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/random.h"
#include "synth/shading.h"

namespace aligngs {

/// Content of one query: an object, or all surface of one stuff class (is_stuff).
struct QueryRegion {
  uint16_t label = 0;
  int key = 0;                // object index, or -1 - label for stuff
  std::vector<uint8_t> mask;  // per image pixel
  int x0 = 1 << 30, y0 = 1 << 30, x1 = -1, y1 = -1;
  size_t pixels = 0;
  double depth_sum = 0;
  size_t border = 0;  // pixels on the border of the image
};

/// By key: stuff first, then objects by number.
std::vector<QueryRegion> query_regions(const RenderedView& view);

/// m_q on the output grid inside a window around the region; elsewhere it is negligible.
struct SoftMask {
  int x0 = 0, y0 = 0;
  ImageF value;
};

/// The mask of a region in an image of w x h pixels, on a grid of out_w x out_h. Its outline is displaced by a smooth
/// random field of `outline_rms` image pixels.
SoftMask soft_mask(const QueryRegion& region, int w, int h, int out_w, int out_h, double outline_rms, Random& random);

}  // namespace aligngs
