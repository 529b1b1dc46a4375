#include "edit/relation/color_words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/angles.h"
#include "core/letter_case.h"
#include "core/srgb.h"
#include "edit/color_names.h"
#include "edit/selection_words.h"
#include "edit/vocabulary.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

/// Colours that a word means. Photos of rooms have duller ones than a table of colours.
struct ColorRange {
  std::string_view word;
  double hue, half_width;  ///< degrees; 180: any
  double darkest, lightest;
  double dullest, brightest;  ///< chroma
};

constexpr double kAnyHue = 180, kMost = 200;
/// The plainest words; the first one that fits describes a colour.
constexpr ColorRange kRanges[] = {{"white", 0, kAnyHue, 78, 100, 0, 12},     {"black", 0, kAnyHue, 0, 25, 0, 12},
                                  {"gray", 0, kAnyHue, 25, 78, 0, 10},       {"beige", 80, 30, 62, 100, 6, 32},
                                  {"brown", 65, 30, 8, 60, 10, 60},          {"yellow", 95, 18, 55, 100, 32, kMost},
                                  {"orange", 60, 20, 50, 85, 40, kMost},     {"red", 28, 22, 12, 65, 26, kMost},
                                  {"pink", 5, 36, 58, 95, 10, kMost},        {"green", 148, 44, 0, 100, 10, kMost},
                                  {"turquoise", 200, 28, 0, 100, 10, kMost}, {"blue", 268, 44, 0, 100, 8, kMost},
                                  {"purple", 318, 28, 0, 100, 8, kMost}};

/// Other words for the same ranges.
constexpr std::pair<std::string_view, std::string_view> kSame[] = {
    {"grey", "gray"},        {"violet", "purple"},   {"lilac", "purple"},    {"cream", "beige"},
    {"reddish", "red"},      {"bluish", "blue"},     {"greenish", "green"},  {"brownish", "brown"},
    {"yellowish", "yellow"}, {"pinkish", "pink"},    {"whitish", "white"},   {"blackish", "black"},
    {"greyish", "gray"},     {"grayish", "gray"},    {"teal", "turquoise"},  {"cyan", "turquoise"},
    {"aqua", "turquoise"},   {"off white", "white"}, {"snow white", "white"}};

constexpr std::string_view kShades[] = {"dark", "deep", "light", "pale", "bright"};

const ColorRange* range_of(std::string_view word) {
  for (const auto& [other, plain] : kSame) {
    if (word == other) word = plain;
  }
  const auto it =
      std::find_if(std::begin(kRanges), std::end(kRanges), [&](const ColorRange& r) { return r.word == word; });
  return it == std::end(kRanges) ? nullptr : &*it;
}

/// "dark green" parted; the shade is empty where the word has none.
std::pair<std::string_view, std::string_view> parted(std::string_view word) {
  for (const std::string_view shade : kShades) {
    if (word.size() > shade.size() + 1 && word.starts_with(shade) && word[shade.size()] == ' ')
      return {shade, word.substr(shade.size() + 1)};
  }
  return {{}, word};
}

bool fits(const ColorRange& range, const SeenColor& color, double slack) {
  const double turn = std::fabs(std::remainder(color.hue - range.hue, 360));
  const double dullest = range.half_width == kAnyHue ? 0 : range.dullest - 4 * slack;
  constexpr double kClearly = 6;  // of chroma: duller colours have a hue that the light changes, so that it must fit
  const double hue_slack = color.chroma >= range.dullest + kClearly ? 12 * slack : 0;
  return turn <= range.half_width + hue_slack && color.lightness >= range.darkest - 8 * slack &&
         color.lightness <= range.lightest + 8 * slack && color.chroma >= dullest &&
         color.chroma <= range.brightest + 5 * slack;
}

bool shade_fits(std::string_view shade, const SeenColor& color, double slack) {
  if (shade == "dark" || shade == "deep") return color.lightness <= 45 + 8 * slack;
  return shade.empty() || shade == "bright" || color.lightness >= 60 - 8 * slack;
}

/// A colour with a name of its own, such as "navy": what looks like it.
ColorRange around(std::string_view word, const std::array<uint8_t, 3>& rgb) {
  const SeenColor c = seen_color(rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
  constexpr double kGray = 12, kTurn = 24, kShadeStep = 25, kShare = 0.25;
  const bool gray = c.chroma < kGray;
  return {word,
          c.hue,
          gray ? kAnyHue : kTurn,
          c.lightness - kShadeStep,
          c.lightness + kShadeStep,
          gray ? 0 : kShare * c.chroma,
          gray ? kGray : kMost};
}

}  // namespace

SeenColor seen_color(double red, double green, double blue) {
  const double r = srgb_decode(static_cast<float>(red)), g = srgb_decode(static_cast<float>(green)),
               b = srgb_decode(static_cast<float>(blue));
  // IEC 61966-2-1, each divided by the white of D65.
  const double x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505, y = 0.2126 * r + 0.7152 * g + 0.0722 * b,
               z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double bright = 116 * f(y) - 16, a = 500 * (f(x) - f(y)), c = 200 * (f(y) - f(z));
  return {bright, std::hypot(a, c), std::atan2(c, a) / kRadiansPerDegree};
}

ColorFit color_fit(const std::string& word, const SeenColor& color) {
  auto [shade, plain] = parted(word);
  const ColorRange* known = range_of(plain);
  ColorRange range;
  if (known) {
    range = *known;
  } else if (const auto rgb = named_color(word)) {
    range = around(word, *rgb);
    shade = {};
  } else {
    return ColorFit::kNo;
  }
  if (fits(range, color, 0) && shade_fits(shade, color, 0)) return ColorFit::kYes;
  return fits(range, color, 1) && shade_fits(shade, color, 1) ? ColorFit::kNearly : ColorFit::kNo;
}

std::string plain_color_word(const SeenColor& color) {
  for (const double slack : {0.0, 1.0, 3.0}) {
    for (const ColorRange& range : kRanges) {
      if (fits(range, color, slack)) return std::string(range.word);
    }
  }
  return "colourful";
}

std::string take_color_word(std::string_view& item) {
  std::string_view rest = trimmed(item);
  take_phrase(rest, "the");
  constexpr int kLongest = 3;  // words: "light sky blue"
  for (int words = kLongest; words > 0; --words) {
    size_t end = 0;
    for (int w = 0; w < words && end != std::string_view::npos; ++w) end = rest.find_first_of(" \t", end + 1);
    if (end == std::string_view::npos) continue;
    std::string name = folded_name(rest.substr(0, end));
    for (const std::string_view tail : {" coloured", " colored"}) {
      if (name.ends_with(tail)) name.resize(name.size() - tail.size());
    }
    if (!range_of(parted(name).second) && !named_color(name)) continue;
    item = trimmed(rest.substr(end));
    return name;
  }
  return "";
}

}  // namespace aligngs
