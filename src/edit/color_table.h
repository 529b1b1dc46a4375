// Colours with a name of one word: those of CSS, and those on tins of paint.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace aligngs {

struct NamedColor {
  std::string_view name;  ///< without blanks, American spelling
  uint32_t rgb;
};

std::span<const NamedColor> css_colors();
std::span<const NamedColor> paint_colors();

/// The colour of a folded name; CSS goes first.
std::optional<std::array<uint8_t, 3>> table_color(std::string_view name);

}  // namespace aligngs
