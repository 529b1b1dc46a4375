// The texture of a surface: its colours without the light on them.
#pragma once

#include <vector>

#include "core/vec.h"
#include "edit/fill/plane_grid.h"
#include "edit/fill/surface_colors.h"

namespace aligngs {

/// One value for each cell of a grid, with a mask.
struct TextureMap {
  int columns = 0, rows = 0;
  std::vector<Vec3f> value;
  std::vector<float> mask;  ///< 1 known, 0 unknown
  size_t index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(columns) + static_cast<size_t>(i);
  }
  bool knows(int i, int j) const { return i >= 0 && j >= 0 && i < columns && j < rows && mask[index(i, j)] > 0; }
};

struct TextureMapSettings {
  double light = 0.36;  ///< scene units: standard deviation of the blur that tells light from texture
  float spreads = 3;  ///< longest difference from the light, in typical ones; longer ones are stains and are shortened
};

/// The mean of the known colours of each cell, less their blur. Nothing of a blotch larger than `light` is left.
TextureMap texture_map(const PlaneGrid& grid, const std::vector<KnownColor>& known,
                       const TextureMapSettings& settings = {});

/// Typical length of the known values: 1.48 times the median. It is 0 without any.
float contrast_of(const TextureMap& map);

}  // namespace aligngs
