// Colours as people name them: "dark green", "light blue", "terracotta".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace aligngs {

/// sRGB of a name of CSS Color Module Level 4 ("dark green" and "darkgreen" alike), or of some names of paints. "Dark",
/// "light", "pale", "deep" or "bright" may precede one of these. Case and hyphens do not matter. Nothing for other
/// texts.
std::optional<std::array<uint8_t, 3>> named_color(std::string_view text);

/// "#rrggbb", "#rgb" or a name; Error{kUsage} for anything else.
std::array<uint8_t, 3> read_color(std::string_view text);

/// Takes a colour off the end of `text`, with "to", "in" or "with" before it: "sofa dark green" leaves "sofa". Nothing
/// where the text ends with no colour: "#rgb", "#rrggbb" or a name.
std::optional<std::array<uint8_t, 3>> take_color(std::string& text);

}  // namespace aligngs
