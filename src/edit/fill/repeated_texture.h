// The texture of a surface where nobody saw it: parquet, tiles, stripes and wallpaper continue in phase.
#pragma once

#include <cstddef>
#include <vector>

#include "edit/fill/texture_map.h"

namespace aligngs {

struct TextureSettings {
  int reach = 90;                ///< cells: longest shift of a pattern on itself
  float least_likeness = 0.3f;   ///< correlation of the surface with its shifted self
  float least_explained = 0.1f;  ///< share of the texture's variance that the pattern has to predict
  size_t most_shifts = 160;      ///< of a pattern
  size_t most_copies = 10;       ///< known places that one place takes the mean of
};

/// Texture of each cell: what is to be added to colours that have only light in them. It is the weighted mean of known
/// places at the shifts at which the surface resembles itself (He and Sun 2012, statistics of patch offsets). The mean
/// is scaled by how well it predicts the known places, each from others. The result is empty without a pattern. The
/// shifts of one half of the surface then explain less than `least_explained` of the other half.
std::vector<Vec3f> repeated_texture(const TextureMap& map, const TextureSettings& settings = {});

}  // namespace aligngs
