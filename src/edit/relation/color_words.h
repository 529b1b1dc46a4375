// Words for the colour of a thing: "red", "dark green", "beige".
#pragma once

#include <string>
#include <string_view>

namespace aligngs {

/// A colour in CIE L*a*b* of D65, as lightness (0 to 100), chroma and hue in degrees.
struct SeenColor {
  double lightness = 0, chroma = 0, hue = 0;
};

/// From sRGB in [0, 1].
SeenColor seen_color(double red, double green, double blue);

enum class ColorFit { kNo, kNearly, kYes };

/// Whether people call a colour so. `word` is one that take_color_word gave.
ColorFit color_fit(const std::string& word, const SeenColor& color);

/// The plainest word for a colour: "brown", "white".
std::string plain_color_word(const SeenColor& color);

/// Takes a colour off the begin of an item where more follows: "dark green" of "the dark green chair". Spelling, case and
/// "-coloured" do not matter. Empty where the item begins otherwise.
std::string take_color_word(std::string_view& item);

}  // namespace aligngs
