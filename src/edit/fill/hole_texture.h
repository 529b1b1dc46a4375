// The texture that continues in a hole of a surface: its pattern in phase, or pieces of what is around.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/plane_grid.h"
#include "edit/fill/surface_colors.h"

namespace aligngs {

inline constexpr float kNewDeviation = 0.75f;  ///< cells: standard deviation of the new Gaussians of a hole

struct HoleTextureSettings {
  double extent = 3;      ///< of the room, scene units
  bool is_floor = false;  ///< boards continue by their directions. On plain walls, noise has a lattice by chance.
};

/// The texture of each cell, to be added to colours that have only light in them. It is that of the hole, and of the
/// known cells as far as a pattern predicts them. It is empty for an even surface and for a faint texture without a pattern. `known` are the
/// constant harmonics of the surface.
///
/// - A pattern that repeats continues in phase (repeated_texture.h).
/// - Boards of a floor whose directions repeat continue in phase, with the shades of other boards (pattern_lattice.h).
/// - A strong texture without either continues in pieces (quilted_texture.h).
std::vector<Vec3f> hole_texture(const PlaneGrid& grid, const std::vector<uint8_t>& hole,
                                const std::vector<KnownColor>& known, const HoleTextureSettings& settings);

}  // namespace aligngs
