// Short titles drawn into pictures: lower-case letters of 5 x 7 pixels, enlarged.
#pragma once

#include <string_view>

#include "core/image.h"

namespace aligngs {

/// Height of a band that holds one line of titles.
inline constexpr int kTitleHeight = 24;

/// Draws `title` with its upper left corner at (x0, y0), in dark grey. Characters other than a to z are blanks; letters
/// outside of the picture are cut off.
void draw_title(Image<uint8_t>& picture, int x0, int y0, std::string_view title);

}  // namespace aligngs
