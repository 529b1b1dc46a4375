#include "edit/color_names.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "edit/edit_operation.h"
#include "edit/selection_words.h"

namespace aligngs {
namespace {

using Color = std::array<uint8_t, 3>;

struct NamedColor {
  std::string_view name;  ///< without blanks, American spelling
  uint32_t rgb;
};

/// CSS Color Module Level 4, section 6.1.
constexpr NamedColor kCss[] = {{"aliceblue", 0xf0f8ff},
                               {"antiquewhite", 0xfaebd7},
                               {"aqua", 0x00ffff},
                               {"aquamarine", 0x7fffd4},
                               {"azure", 0xf0ffff},
                               {"beige", 0xf5f5dc},
                               {"bisque", 0xffe4c4},
                               {"black", 0x000000},
                               {"blanchedalmond", 0xffebcd},
                               {"blue", 0x0000ff},
                               {"blueviolet", 0x8a2be2},
                               {"brown", 0xa52a2a},
                               {"burlywood", 0xdeb887},
                               {"cadetblue", 0x5f9ea0},
                               {"chartreuse", 0x7fff00},
                               {"chocolate", 0xd2691e},
                               {"coral", 0xff7f50},
                               {"cornflowerblue", 0x6495ed},
                               {"cornsilk", 0xfff8dc},
                               {"crimson", 0xdc143c},
                               {"cyan", 0x00ffff},
                               {"darkblue", 0x00008b},
                               {"darkcyan", 0x008b8b},
                               {"darkgoldenrod", 0xb8860b},
                               {"darkgray", 0xa9a9a9},
                               {"darkgreen", 0x006400},
                               {"darkkhaki", 0xbdb76b},
                               {"darkmagenta", 0x8b008b},
                               {"darkolivegreen", 0x556b2f},
                               {"darkorange", 0xff8c00},
                               {"darkorchid", 0x9932cc},
                               {"darkred", 0x8b0000},
                               {"darksalmon", 0xe9967a},
                               {"darkseagreen", 0x8fbc8f},
                               {"darkslateblue", 0x483d8b},
                               {"darkslategray", 0x2f4f4f},
                               {"darkturquoise", 0x00ced1},
                               {"darkviolet", 0x9400d3},
                               {"deeppink", 0xff1493},
                               {"deepskyblue", 0x00bfff},
                               {"dimgray", 0x696969},
                               {"dodgerblue", 0x1e90ff},
                               {"firebrick", 0xb22222},
                               {"floralwhite", 0xfffaf0},
                               {"forestgreen", 0x228b22},
                               {"fuchsia", 0xff00ff},
                               {"gainsboro", 0xdcdcdc},
                               {"ghostwhite", 0xf8f8ff},
                               {"gold", 0xffd700},
                               {"goldenrod", 0xdaa520},
                               {"gray", 0x808080},
                               {"green", 0x008000},
                               {"greenyellow", 0xadff2f},
                               {"honeydew", 0xf0fff0},
                               {"hotpink", 0xff69b4},
                               {"indianred", 0xcd5c5c},
                               {"indigo", 0x4b0082},
                               {"ivory", 0xfffff0},
                               {"khaki", 0xf0e68c},
                               {"lavender", 0xe6e6fa},
                               {"lavenderblush", 0xfff0f5},
                               {"lawngreen", 0x7cfc00},
                               {"lemonchiffon", 0xfffacd},
                               {"lightblue", 0xadd8e6},
                               {"lightcoral", 0xf08080},
                               {"lightcyan", 0xe0ffff},
                               {"lightgoldenrodyellow", 0xfafad2},
                               {"lightgray", 0xd3d3d3},
                               {"lightgreen", 0x90ee90},
                               {"lightpink", 0xffb6c1},
                               {"lightsalmon", 0xffa07a},
                               {"lightseagreen", 0x20b2aa},
                               {"lightskyblue", 0x87cefa},
                               {"lightslategray", 0x778899},
                               {"lightsteelblue", 0xb0c4de},
                               {"lightyellow", 0xffffe0},
                               {"lime", 0x00ff00},
                               {"limegreen", 0x32cd32},
                               {"linen", 0xfaf0e6},
                               {"magenta", 0xff00ff},
                               {"maroon", 0x800000},
                               {"mediumaquamarine", 0x66cdaa},
                               {"mediumblue", 0x0000cd},
                               {"mediumorchid", 0xba55d3},
                               {"mediumpurple", 0x9370db},
                               {"mediumseagreen", 0x3cb371},
                               {"mediumslateblue", 0x7b68ee},
                               {"mediumspringgreen", 0x00fa9a},
                               {"mediumturquoise", 0x48d1cc},
                               {"mediumvioletred", 0xc71585},
                               {"midnightblue", 0x191970},
                               {"mintcream", 0xf5fffa},
                               {"mistyrose", 0xffe4e1},
                               {"moccasin", 0xffe4b5},
                               {"navajowhite", 0xffdead},
                               {"navy", 0x000080},
                               {"oldlace", 0xfdf5e6},
                               {"olive", 0x808000},
                               {"olivedrab", 0x6b8e23},
                               {"orange", 0xffa500},
                               {"orangered", 0xff4500},
                               {"orchid", 0xda70d6},
                               {"palegoldenrod", 0xeee8aa},
                               {"palegreen", 0x98fb98},
                               {"paleturquoise", 0xafeeee},
                               {"palevioletred", 0xdb7093},
                               {"papayawhip", 0xffefd5},
                               {"peachpuff", 0xffdab9},
                               {"peru", 0xcd853f},
                               {"pink", 0xffc0cb},
                               {"plum", 0xdda0dd},
                               {"powderblue", 0xb0e0e6},
                               {"purple", 0x800080},
                               {"rebeccapurple", 0x663399},
                               {"red", 0xff0000},
                               {"rosybrown", 0xbc8f8f},
                               {"royalblue", 0x4169e1},
                               {"saddlebrown", 0x8b4513},
                               {"salmon", 0xfa8072},
                               {"sandybrown", 0xf4a460},
                               {"seagreen", 0x2e8b57},
                               {"seashell", 0xfff5ee},
                               {"sienna", 0xa0522d},
                               {"silver", 0xc0c0c0},
                               {"skyblue", 0x87ceeb},
                               {"slateblue", 0x6a5acd},
                               {"slategray", 0x708090},
                               {"snow", 0xfffafa},
                               {"springgreen", 0x00ff7f},
                               {"steelblue", 0x4682b4},
                               {"tan", 0xd2b48c},
                               {"teal", 0x008080},
                               {"thistle", 0xd8bfd8},
                               {"tomato", 0xff6347},
                               {"turquoise", 0x40e0d0},
                               {"violet", 0xee82ee},
                               {"wheat", 0xf5deb3},
                               {"white", 0xffffff},
                               {"whitesmoke", 0xf5f5f5},
                               {"yellow", 0xffff00},
                               {"yellowgreen", 0x9acd32}};

/// Names on tins of paint that CSS lacks.
constexpr NamedColor kPaints[] = {
    {"anthracite", 0x383e42}, {"apricot", 0xfbceb1}, {"burgundy", 0x800020},  {"caramel", 0xc68e4d},
    {"charcoal", 0x36454f},   {"cream", 0xfffdd0},   {"lilac", 0xc8a2c8},     {"mint", 0x98ff98},
    {"mustard", 0xe1ad01},    {"ochre", 0xcc7722},   {"offwhite", 0xfaf9f6},  {"peach", 0xffe5b4},
    {"petrol", 0x005f6a},     {"rose", 0xff8fab},    {"rust", 0xb7410e},      {"sage", 0x9caf88},
    {"sand", 0xc2b280},       {"taupe", 0x8b7e74},   {"terracotta", 0xe2725b}};

constexpr int kMostWords = 3;  // of a colour's name: "light sky blue"

/// Lower case without blanks, hyphens and underscores; "grey" is "gray".
std::string folded(std::string_view text) {
  std::string out;
  for (const char raw : text) {
    const unsigned char c = static_cast<unsigned char>(raw);
    if (!std::isspace(c) && raw != '-' && raw != '_') out += static_cast<char>(std::tolower(c));
  }
  for (size_t at = out.find("grey"); at != std::string::npos; at = out.find("grey", at)) out[at + 2] = 'a';
  return out;
}

std::optional<Color> table_color(std::string_view name) {
  const auto find = [&](const auto& table) -> std::optional<Color> {
    for (const NamedColor& c : table) {
      if (c.name == name) {
        return Color{static_cast<uint8_t>(c.rgb >> 16), static_cast<uint8_t>(c.rgb >> 8 & 255),
                     static_cast<uint8_t>(c.rgb & 255)};
      }
    }
    return {};
  };
  const auto css = find(kCss);
  return css ? css : find(kPaints);
}

Color mixed(const Color& color, double other, double share) {
  Color out;
  for (size_t c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>(std::lround((1 - share) * color[c] + share * other));
  return out;
}

bool is_hex_color(std::string_view text) {
  const auto is_hex = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  return (text.size() == 4 || text.size() == 7) && text[0] == '#' && std::all_of(text.begin() + 1, text.end(), is_hex);
}

/// Beginning of the last `words` words of a trimmed text; npos when it has fewer.
size_t begin_of_last_words(std::string_view text, int words) {
  size_t begin = text.size();
  for (int w = 0; w < words; ++w) {
    if (begin == 0 || text.empty()) return std::string_view::npos;
    const size_t end = text.find_last_not_of(" \t", begin - 1);
    if (end == std::string_view::npos) return end;
    const size_t blank = text.find_last_of(" \t", end);
    begin = blank == std::string_view::npos ? 0 : blank + 1;
  }
  return begin;
}

std::string_view without_preposition(std::string_view text) {
  const size_t begin = begin_of_last_words(text, 1);
  if (begin == std::string_view::npos) return text;
  const std::string last = folded(text.substr(begin));
  return last == "to" || last == "in" || last == "with" ? trimmed(text.substr(0, begin)) : text;
}

}  // namespace

std::optional<Color> named_color(std::string_view text) {
  const std::string name = folded(text);
  if (const auto color = table_color(name)) return color;
  struct Shade {
    std::string_view word;
    double other, share;  ///< sRGB level that is mixed in, and its share
  };
  constexpr Shade kShades[] = {
      {"dark", 0, 0.45}, {"deep", 0, 0.3}, {"light", 255, 0.5}, {"pale", 255, 0.65}, {"bright", 255, 0.15}};
  for (const Shade& shade : kShades) {
    if (name.rfind(shade.word, 0) != 0) continue;
    if (const auto color = table_color(std::string_view(name).substr(shade.word.size())))
      return mixed(*color, shade.other, shade.share);
  }
  return {};
}

Color read_color(std::string_view text) {
  text = trimmed(text);
  if (const auto color = named_color(text)) return *color;
  if (!text.empty() && text.front() == '#') return parse_color(text);
  throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no colour",
              "write it as '#rrggbb', for example '#add8e6', or as a name, for example \"dark green\"");
}

std::optional<Color> take_color(std::string& text) {
  const std::string_view whole = trimmed(text);
  // The longest name wins: "dark green" goes before "green".
  for (int words = kMostWords; words > 0; --words) {
    const size_t begin = begin_of_last_words(whole, words);
    if (begin == std::string_view::npos) continue;
    const std::string_view tail = whole.substr(begin);
    const std::optional<Color> color = words == 1 && is_hex_color(tail) ? parse_color(tail) : named_color(tail);
    if (!color) continue;
    text = std::string(without_preposition(trimmed(whole.substr(0, begin))));
    return color;
  }
  return {};
}

}  // namespace aligngs
