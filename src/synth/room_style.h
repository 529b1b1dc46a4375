// The materials of one room, drawn from a seed so that its pieces go together.
#pragma once

#include "core/random.h"
#include "synth/textures.h"

namespace aligngs {

struct RoomStyle {
  Material bare_paint;    ///< walls and ceiling: near-white, no texture
  Material feature_wall;  ///< the one wall with wallpaper, brick or coloured plaster
  Material floor;
  Material skirting;
  Material wood, second_wood, lacquer;  ///< furniture
  Material metal, dark_metal, black_gloss, white_plastic, black_plastic;
  Material upholstery, second_upholstery;  ///< sofas, chairs
  Material bed_cloth, throw_cloth, linen;  ///< bed
  Material cushion_a, cushion_b, cushion_c;
  Material curtain, rug, lampshade, ceramic, leaf, soil, wicker, counter;
};

/// `glossy`: polished floor and table tops.
RoomStyle make_room_style(Random& random, bool glossy);

/// A copy of a material with another seed: the same stuff, another piece of it.
Material another(const Material& material, Random& random);
/// A painting, book cover, ... of the given kind.
Material picture_material(TextureKind kind, Random& random);
Material book_material(Random& random);

}  // namespace aligngs
