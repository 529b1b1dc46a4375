#include "edit/motion_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <regex>

#include "core/error.h"
#include "edit/selection_words.h"

namespace aligngs {
namespace {

constexpr double kLongestShift = 1000;  // scene units; no room is larger
constexpr double kFullTurn = 360;       // degrees

std::optional<double> number_of(std::string_view text, double largest) {
  text = trimmed(text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(std::fabs(value) <= largest)) return {};
  return value;
}

struct Direction {
  std::string_view word;
  Vec3d axis;
};
constexpr Direction kDirections[] = {{"right", {1, 0, 0}}, {"left", {-1, 0, 0}},  {"up", {0, 1, 0}},
                                     {"down", {0, -1, 0}}, {"closer", {0, 0, 1}}, {"forward", {0, 0, 1}},
                                     {"back", {0, 0, -1}}, {"away", {0, 0, -1}}};

const std::regex& along_axes() {
  static const std::regex pattern(
      R"(^(.*\S) +by +([-+.0-9e]+ *, *[-+.0-9e]+ *, *[-+.0-9e]+)( +and +turn +by +([-+.0-9e]+))?$)", std::regex::icase);
  return pattern;
}

const std::regex& in_a_direction() {
  static const std::regex pattern(
      R"(^(.*?\S)( +by)? +([.0-9]+) *(m|metres?|meters?)?( +to +the)? +(left|right|up|down|closer|forward|back|away)$)",
      std::regex::icase);
  return pattern;
}

const std::regex& by_degrees() {
  static const std::regex pattern(R"(^(.*?\S)( +by)? +([-+.0-9]+)( +degrees?)?( +(counter-?clockwise|clockwise))?$)",
                                  std::regex::icase);
  return pattern;
}

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace

Vec3d parse_shift(std::string_view text) {
  Vec3d shift;
  std::string_view rest = text;
  bool good = true;
  for (int a = 0; a < 3 && good; ++a) {
    const size_t comma = rest.find(',');
    good = (comma == std::string_view::npos) == (a == 2);
    const auto value = number_of(rest.substr(0, comma), kLongestShift);
    good = good && value.has_value();
    if (good) shift[a] = *value;
    if (comma != std::string_view::npos) rest.remove_prefix(comma + 1);
  }
  if (!good) {
    throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no motion",
                "give three numbers: to the right, upwards, towards the viewer, for example \"0.5,0,-0.2\"");
  }
  return shift;
}

double parse_turn(std::string_view text) {
  const auto turn = number_of(text, kFullTurn);
  if (!turn)
    throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no angle",
                "give degrees from -360 to 360, for example 90");
  return *turn;
}

std::optional<ObjectMotion> take_motion(std::string& text) {
  std::smatch match;
  ObjectMotion motion;
  if (std::regex_match(text, match, along_axes())) {
    motion.shift = parse_shift(match[2].str());
    if (match[4].matched) motion.turn = parse_turn(match[4].str());
    text = std::string(match[1].str());
    return motion;
  }
  if (!std::regex_match(text, match, in_a_direction())) return {};
  const auto length = number_of(match[3].str(), kLongestShift);
  if (!length)
    throw_usage("\"" + match[3].str() + "\" is no length", "give metres, for example \"move chair 0.5 m to the left\"");
  for (const Direction& d : kDirections) {
    if (lower(match[6].str()) == d.word) motion.shift = d.axis * *length;
  }
  text = std::string(match[1].str());
  return motion;
}

std::optional<double> take_turn(std::string& text) {
  std::smatch match;
  if (!std::regex_match(text, match, by_degrees())) return {};
  const double turn = parse_turn(match[3].str());
  const bool clockwise = lower(match[6].str()) == "clockwise";
  text = std::string(match[1].str());
  return clockwise ? -turn : turn;
}

std::string motion_text(const ObjectMotion& motion) {
  if (motion.is_still()) return "";
  const Vec3d& s = motion.shift;
  std::string text = fmt::format(" by {:.9g},{:.9g},{:.9g}", s.x, s.y, s.z);
  if (motion.turn != 0) text += fmt::format(" and turn by {:.9g}", motion.turn);
  return text;
}

}  // namespace aligngs
