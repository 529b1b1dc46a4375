#include "edit/color_names.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include "core/edit_distance.h"
#include "core/error.h"
#include "edit/color_table.h"
#include "edit/edit_operation.h"
#include "edit/selection_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

using Color = std::array<uint8_t, 3>;

/// "Navy blue" and "lime green" are "navy" and "lime".
constexpr std::string_view kHues[] = {"blue", "green", "red",  "yellow", "orange", "brown",
                                      "pink", "white", "gray", "black",  "purple", "violet"};

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
  const auto is_hue = [](std::string_view word) {
    return std::find(std::begin(kHues), std::end(kHues), word) != std::end(kHues);
  };
  for (const std::string_view hue : kHues) {
    if (name.size() <= hue.size() || !name.ends_with(hue)) continue;
    const std::string_view first = std::string_view(name).substr(0, name.size() - hue.size());
    if (!is_hue(first)) return table_color(first);
  }
  return {};
}

/// Names of colours with few other letters, or with which the word begins; the nearest first.
std::vector<std::string> near_colors(std::string_view text) {
  const std::string word = folded(text);
  constexpr size_t kLongestWord = 32, kMost = 3, kStem = 3;
  if (word.empty() || word.size() > kLongestWord) return {};
  std::vector<std::pair<size_t, std::string>> near;
  const auto add = [&](const NamedColor& color) {
    const std::string name(color.name);
    const bool is_stem = name.size() >= kStem && word.starts_with(name);  // "reddish"
    const size_t distance = is_stem ? 0 : edit_distance(word, name);
    if (distance <= std::max<size_t>(2, word.size() / 3)) near.push_back({distance, name});
  };
  for (const NamedColor& color : css_colors()) add(color);
  for (const NamedColor& color : paint_colors()) add(color);
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> out;
  for (size_t i = 0; i < near.size() && i < kMost; ++i) out.push_back(near[i].second);
  return out;
}

Color read_color(std::string_view text) {
  text = trimmed(text);
  if (const auto color = named_color(text)) return *color;
  if (!text.empty() && text.front() == '#') return parse_color(text);
  std::string near;
  for (const std::string& name : near_colors(text)) near += (near.empty() ? "did you mean \"" : " or \"") + name + "\"";
  throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no colour",
              (near.empty() ? "" : near + "? ") +
                  "write it as '#rrggbb', for example '#add8e6', or as a name, for example \"dark green\"");
}

std::optional<Color> take_color(std::string& text) {
  const std::string_view whole = trimmed(text);
  // The longest name wins: "dark green" goes before "green".
  for (int words = kMostWords; words > 0; --words) {
    const size_t begin = begin_of_last_words(whole, words);
    if (begin == std::string_view::npos || (begin == 0 && words > 1)) continue;  // "sand red": an object and a colour
    const std::string_view tail = whole.substr(begin);
    const std::optional<Color> color = words == 1 && is_hex_color(tail) ? parse_color(tail) : named_color(tail);
    if (!color) continue;
    text = std::string(without_preposition(trimmed(whole.substr(0, begin))));
    return color;
  }
  return {};
}

}  // namespace aligngs
