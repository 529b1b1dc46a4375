// Jumps of depth, and the flying pixels that networks make of them.
#pragma once

#include "core/image.h"
#include "synth/shading.h"

namespace aligngs {

/// Per pixel: distance in pixels to the nearest depth jump within `radius`, and the depth across it; 0 where there
/// is none. Used to mix depths over edges.
struct DepthJumps {
  ImageF distance, other;
};
DepthJumps find_depth_jumps(const RenderedView& view, int radius);

/// Mixes depths across jumps with a sigmoid of the given width in pixels: flying pixels.
ImageF mix_across_edges(const ImageF& depth, const DepthJumps& jumps, double width);

}  // namespace aligngs
