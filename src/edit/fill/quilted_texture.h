// A texture where nobody saw it, from pieces of the surface around.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/texture_map.h"

namespace aligngs {

struct QuiltSettings {
  int piece = 24;           ///< cells: edge of a piece
  int overlap = 8;          ///< cells: pieces share so much with what is there
  float guide_share = 0.5;  ///< weight of the distance to the guide, beside that to what is there
};

/// How the pieces shall look. Both fields are in the same unit, such as colours or directions of strokes.
struct QuiltGuide {
  std::vector<Vec3f> looks;   ///< of each known cell; empty: the texture itself
  std::vector<Vec3f> wanted;  ///< of each cell of the hole
  bool is_exact = false;      ///< the pattern repeats: the same piece may lie beside itself
};

/// Texture of the cells marked in `hole`; 0 elsewhere. Pieces of the known texture are laid one beside the other. Each
/// is the one that fits best to what is there already (Efros and Freeman 2001, image quilting). It fits to the guide, too,
/// such as a pattern in phase. A null pointer is no guide. The result is empty where the known texture has no whole
/// piece.
std::vector<Vec3f> quilted_texture(const TextureMap& map, const std::vector<uint8_t>& hole, const QuiltGuide* guide,
                                   const QuiltSettings& settings = {});

}  // namespace aligngs
