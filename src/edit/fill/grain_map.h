// The direction of a texture's strokes: boards, joints and stripes, whatever the shade of each.
#pragma once

#include "edit/fill/texture_map.h"

namespace aligngs {

/// Per known cell the structure tensor of the brightness around it, over its trace (Bigun and Granlund 1987). x and y
/// are cos 2a and sin 2a of the direction a of the strongest change, less their mean over the surface. They are the
/// smaller the more directions there are, and z is 0. Boards differ in shade at random, so that the colours of a parquet do not resemble each other. Their
/// directions do. `reach`: standard deviation of the mean around a cell, in cells.
TextureMap grain_map(const TextureMap& texture, double reach);

}  // namespace aligngs
