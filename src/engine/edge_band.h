// Bands of pixels along the edges of a map.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/image.h"

namespace aligngs {

/// 1 within `radius` pixels (at least 1) on either side of every edge. At an edge, differs(i, j) holds for the pixel
/// indices of two horizontal or vertical neighbours. radius 1 marks the two pixels themselves, a larger one grows them
/// by radius - 1 in each direction.
template <class Differs>
Image<uint8_t> edge_band(int width, int height, int radius, const Differs& differs) {
  Image<uint8_t> edge(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      if (x + 1 < width && differs(i, i + 1)) edge.data[i] = edge.data[i + 1] = 1;
      if (y + 1 < height && differs(i, i + width)) edge.data[i] = edge.data[i + width] = 1;
    }
  }
  const int grow = radius - 1;
  if (grow <= 0) return edge;
  Image<uint8_t> rows(width, height, 1), band(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!edge.at(x, y)) continue;
      for (int k = std::max(0, x - grow); k <= std::min(width - 1, x + grow); ++k) rows.at(k, y) = 1;
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int k = std::max(0, y - grow); k <= std::min(height - 1, y + grow); ++k) {
      for (int x = 0; x < width; ++x) band.at(x, k) |= rows.at(x, y);
    }
  }
  return band;
}

}  // namespace aligngs
