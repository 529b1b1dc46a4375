// The texture of a surface where nobody saw it: parquet, tiles, stripes and wallpaper continue in phase.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/plane_grid.h"
#include "edit/fill/surface_colors.h"

namespace aligngs {

/// Lengths are in scene units.
struct TextureSettings {
  double light = 0.36;  ///< standard deviation of the blur that tells light from texture; larger than a pattern
  double reach = 1.8;   ///< longest shift of a pattern on itself
  float least_contrast = 0.05f;  ///< typical distance of a colour from the light's; less is noise
  float least_likeness = 0.3f;   ///< correlation of the surface with its shifted self
  float least_explained = 0.1f;  ///< share of the texture's variance that the pattern has to predict
  size_t most_shifts = 160;      ///< of a pattern
  size_t most_copies = 10;       ///< known places that one place takes the mean of
};

/// Texture of each cell: what is to be added to colours that have only light in them. It is the weighted mean of known
/// places at the shifts at which the surface resembles itself (He and Sun 2012, statistics of patch offsets). The mean
/// is scaled by how well it predicts the known places, each from others. The result is empty without a pattern. The
/// shifts of one half of the surface then explain less than `least_explained` of the other half.
std::vector<Vec3f> repeated_texture(const PlaneGrid& grid, const std::vector<KnownColor>& known,
                                    const TextureSettings& settings = {});

}  // namespace aligngs
