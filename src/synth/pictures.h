// Procedural pictures over the unit square: paintings, the view out of a window, screens, keyboards.
#pragma once

#include "synth/textures.h"

namespace aligngs {

/// An abstract painting; its manner (blocks, landscape, circles, brush strokes) and colours follow the seed.
Vec3f painting_color(const Material& material, float u, float v);
/// Sky, trees and lawn, out of focus.
Vec3f garden_color(const Material& material, float u, float v);
/// A desktop with windows and lines of text.
Vec3f screen_color(const Material& material, float u, float v);
Vec3f keyboard_color(const Material& material, float u, float v);

}  // namespace aligngs
