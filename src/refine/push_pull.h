// Colours known in some places spread over a whole map.
#pragma once

#include "core/image.h"

namespace aligngs {

/// Push-pull interpolation (Gortler et al., The Lumigraph, 1996). Halves the map until every pixel knows a colour, then
/// fills each finer map's gaps from the coarser one. `color`: H x W x 3. `weight`: H x W, 1 where the colour is known
/// and kept, 0 where it is not. Known nowhere: black.
ImageF push_pull(const ImageF& color, const ImageF& weight);

}  // namespace aligngs
