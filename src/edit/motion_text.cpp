#include "edit/motion_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <regex>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/length_words.h"
#include "edit/selection_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr double kLongestShift = 1000;  // scene units; no room is larger
constexpr double kFullTurn = 360;       // degrees

/// A comma counts as a decimal point.
std::optional<double> number_of(std::string_view given, double largest) {
  std::string text(trimmed(given));
  std::replace(text.begin(), text.end(), ',', '.');
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(std::fabs(value) <= largest)) return {};
  return value;
}

struct Direction {
  std::string_view word;
  Vec3d axis;
};
constexpr Direction kDirections[] = {{"right", {1, 0, 0}},    {"left", {-1, 0, 0}},      {"upwards", {0, 1, 0}},
                                     {"up", {0, 1, 0}},       {"downwards", {0, -1, 0}}, {"down", {0, -1, 0}},
                                     {"higher", {0, 1, 0}},   {"lower", {0, -1, 0}},     {"closer", {0, 0, 1}},
                                     {"forwards", {0, 0, 1}}, {"forward", {0, 0, 1}},    {"backwards", {0, 0, -1}},
                                     {"back", {0, 0, -1}},    {"away", {0, 0, -1}}};

struct Unit {
  std::string_view word;
  double metres;
};
constexpr Unit kUnits[] = {{"m", 1},       {"metre", 1},          {"meter", 1},
                           {"cm", 0.01},   {"centimetre", 0.01},  {"centimeter", 0.01},
                           {"mm", 0.001},  {"millimetre", 0.001}, {"millimeter", 0.001},
                           {"in", 0.0254}, {"inch", 0.0254},      {"inche", 0.0254},
                           {"ft", 0.3048}, {"foot", 0.3048},      {"feet", 0.3048}};

constexpr const char* kLength = R"(([-+]?[0-9]*[.,]?[0-9]+(?:e[-+]?[0-9]+)?))";
constexpr const char* kUnit =
    R"((m|metres?|meters?|cm|centimetres?|centimeters?|mm|millimetres?|millimeters?|in|inch|inches|ft|foot|feet))";
constexpr const char* kDirection =
    R"((left|right|upwards|up|higher|downwards|down|lower|closer|towards? +(?:me|us|the +(?:camera|viewer))|forwards|forward|backwards|back|away))";

const std::regex& along_axes() {
  static const std::regex pattern(
      R"(^(.*\S) +by +([-+.0-9e]+ *, *[-+.0-9e]+ *, *[-+.0-9e]+|[-+.,0-9e]+(?: *; *| +)[-+.,0-9e]+(?: *; *| +)[-+.,0-9e]+))"
      R"(( +and +turn +by +([-+.,0-9e]+))?$)",
      std::regex::icase);
  return pattern;
}

/// "0.5 m to the left", "50cm up": what comes before, length, unit, direction.
const std::regex& in_a_direction() {
  static const std::regex pattern(
      fmt::format("^(.*?\\S)(?: +by)? +{} *{}?(?: +to +the)? +{}$", kLength, kUnit, kDirection), std::regex::icase);
  return pattern;
}

/// "to the left by 0.5 m", "up 20 cm": what comes before, direction, length, unit.
const std::regex& direction_first() {
  static const std::regex pattern(
      fmt::format("^(.*?\\S)(?: +to +the)? +{}(?: +by)? +{} *{}?$", kDirection, kLength, kUnit), std::regex::icase);
  return pattern;
}

/// "50cm" at the end, without a direction.
const std::regex& a_length_alone() {
  static const std::regex pattern(fmt::format("^.*\\S +{} *{}$", kLength, kUnit), std::regex::icase);
  return pattern;
}

/// "50 cm towards the window" and "0.5 m away from the bed": what comes before, length, unit, words, thing.
const std::regex& toward_a_thing() {
  static const std::regex pattern(
      fmt::format("^(.*?\\S)(?: +by)? +{} *{}? +(towards?|(?:closer|nearer) +to|away +from) +(?:the +)?(\\S.*)$",
                  kLength, kUnit),
      std::regex::icase);
  return pattern;
}

/// "20 cm against the wall" and "20 cm north": what comes before, length, unit, and words that are no direction.
const std::regex& length_before_words() {
  static const std::regex pattern(fmt::format("^(.*?\\S)(?: +by)? +{} *{} +(\\S.*)$", kLength, kUnit),
                                  std::regex::icase);
  return pattern;
}

/// The same, with the thing first: "towards the window by 50 cm".
const std::regex& thing_first() {
  static const std::regex pattern(
      fmt::format("^(.*?\\S) +(towards?|(?:closer|nearer) +to|away +from) +(?:the +)?(\\S.*?)(?: +by)? +{} *{}$",
                  kLength, kUnit),
      std::regex::icase);
  return pattern;
}

/// "To the window": no length.
const std::regex& to_a_thing() {
  static const std::regex pattern(
      "^(.*?\\S) +((?:towards?|(?:closer|nearer) +to|away +from|to|next +to|beside|near|against|in +front "
      "+of|behind|on|"
      "under|into|between) +\\S.*)$",
      std::regex::icase);
  return pattern;
}

double metres_of(std::string unit) {
  unit = lower_case(unit);
  if (unit.size() > 2 && unit.back() == 's') unit.pop_back();
  double metres = 1;
  for (const Unit& known : kUnits) metres = known.word == unit ? known.metres : metres;
  return metres;
}

[[noreturn]] void refuse_length(const std::string& length, const char* example) {
  throw_usage(fmt::format("\"{}\" is no length of at most {:.0f} metres or scene units", length, kLongestShift),
              std::string("for example \"move chair 0.5 m ") + example + "\"");
}

/// "1,500 mm" has two readings: three digits follow its only mark.
void refuse_thousands(const std::string& length, const std::string& unit, double largest) {
  constexpr size_t kThousands = 3, kLongestBefore = 3;  // digits
  const size_t begin = length.find_first_of("0123456789"), mark = length.find_first_of(".,");
  if (mark == std::string::npos || begin >= mark || length[begin] == '0' || mark - begin > kLongestBefore) return;
  const std::string whole = length.substr(0, mark), after = length.substr(mark + 1);
  if (after.size() != kThousands || after.find_first_not_of("0123456789") != std::string::npos) return;
  const auto decimal = number_of(length, largest), thousands = number_of(whole + after, largest);
  if (!decimal || !thousands) return;
  const std::string in = unit.empty() ? "" : " " + unit;
  throw_usage("\"" + length + in + "\" has two readings",
              fmt::format("did you mean \"{:g}{}\" or \"{:g}{}\"?", *decimal, in, *thousands, in));
}

/// In metres or scene units; nothing for what is no length.
std::optional<double> length_of(const std::string& length, const std::string& unit) {
  const double metres = metres_of(unit), largest = kLongestShift / metres;
  refuse_thousands(length, unit, largest);
  const auto value = number_of(length, largest);
  return value ? std::optional<double>(*value * metres) : std::nullopt;
}

ObjectMotion motion_toward(const std::string& length, const std::string& unit, const std::string& words,
                           const std::string& thing) {
  const auto value = length_of(length, unit);
  if (!value || *value == 0) refuse_length(length, "towards the window");
  ObjectMotion motion;
  motion.in_metres = !unit.empty();
  motion.toward = thing;
  motion.distance = (lower_case(words).starts_with("away") ? -1 : 1) * *value;
  return motion;
}

/// Words of `length`, `unit` (may be empty) and `direction` as a shift.
Vec3d shift_along(const std::string& length, const std::string& unit, std::string direction) {
  const auto value = length_of(length, unit);
  if (!value) refuse_length(length, "to the left");
  direction = lower_case(direction);
  if (direction.starts_with("toward")) direction = "closer";
  for (const Direction& known : kDirections) {
    if (direction == known.word) return known.axis * *value + Vec3d{};  // without -0
  }
  return {};
}

/// Nothing where the text has another number of parts, or a part is no number. "0,5 0 -0,2" has blanks between.
std::optional<Vec3d> three_numbers(std::string_view text, char separator) {
  Vec3d out;
  for (int a = 0; a < 3; ++a) {
    const size_t end = text.find(separator);
    if ((end == std::string_view::npos) != (a == 2)) return {};
    const auto value = number_of(text.substr(0, end), kLongestShift);
    if (!value) return {};
    out[a] = *value;
    if (end != std::string_view::npos) text = trimmed(text.substr(end + 1));
  }
  return out;
}

/// "1 m to the left and 0.5 m back": what was before the last motion.
void add_earlier(std::string& text, ObjectMotion& motion) {
  std::string rest = text;
  constexpr std::string_view kAnd = " and";
  if (rest.size() <= kAnd.size() || !lower_case(rest).ends_with(kAnd)) return;
  rest.resize(rest.size() - kAnd.size());
  std::smatch match;
  if (!std::regex_match(rest, match, in_a_direction())) return;
  motion.shift += shift_along(match[2].str(), match[3].str(), match[4].str());
  motion.in_metres |= match[3].length() > 0;
  text = match[1].str();
}

}  // namespace

Vec3d parse_shift(std::string_view text) {
  std::optional<Vec3d> shift;
  for (const char separator : {';', ',', ' '}) {
    if (!shift) shift = three_numbers(trimmed(text), separator);
  }
  if (!shift) {
    throw_usage(
        "\"" + std::string(text.substr(0, 40)) + "\" is no motion",
        fmt::format("give three numbers of at most {:.0f}: to the right, upwards, towards the viewer, for example "
                    "\"0.5,0,-0.2\"",
                    kLongestShift));
  }
  return *shift;
}

double parse_turn(std::string_view text) {
  const auto turn = number_of(text, kFullTurn);
  if (!turn)
    throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no angle",
                "give degrees from -360 to 360, for example 90");
  return *turn;
}

std::optional<ObjectMotion> take_motion(std::string& given) {
  std::smatch match;
  std::string text = with_plain_lengths(given);
  ObjectMotion motion;
  if (std::regex_match(text, match, along_axes())) {
    motion.shift = parse_shift(match[2].str());
    if (match[4].matched) motion.turn = parse_turn(match[4].str());
    given = std::string(match[1].str());
    return motion;
  }
  if (std::regex_match(text, match, in_a_direction())) {
    motion.shift = shift_along(match[2].str(), match[3].str(), match[4].str());
    motion.in_metres = match[3].length() > 0;
  } else if (std::regex_match(text, match, direction_first())) {
    motion.shift = shift_along(match[3].str(), match[4].str(), match[2].str());
    motion.in_metres = match[4].length() > 0;
  } else if (std::regex_match(text, match, toward_a_thing())) {
    motion = motion_toward(match[2].str(), match[3].str(), match[4].str(), match[5].str());
  } else if (std::regex_match(text, match, thing_first())) {
    motion = motion_toward(match[4].str(), match[5].str(), match[2].str(), match[3].str());
  } else if (std::regex_match(text, a_length_alone())) {
    throw_usage("the motion has a length and no direction", "for example \"move chair 0.5 m to the left\"");
  } else {
    return {};
  }
  given = std::string(match[1].str());
  if (motion.toward.empty()) add_earlier(given, motion);
  return motion;
}

void refuse_place(const std::string& given) {
  std::smatch match;
  const std::string text = with_plain_lengths(given);
  const auto thing_of = [](const std::string& place) {
    return std::regex_replace(place, std::regex("^.*? +((?:to|from|of) +)?"), "",
                              std::regex_constants::format_first_only);
  };
  if (std::regex_match(text, match, length_before_words()) && lower_case(match[3].str()) != "in") {
    const std::string words = match[4].str(), rest = "x " + words;
    static const std::regex compass("(?:to +)?(?:the +)?(?:north|south|east|west)(?:[- ]?(?:east|west))?(?:wards?)?",
                                    std::regex::icase);
    const bool is_place = std::regex_match(rest, to_a_thing()) && !std::regex_match(words, compass);
    throw_usage("\"" + words + "\" is no direction",
                is_place ? "did you mean \"move " + match[1].str() + " " + match[2].str() + " " + match[3].str() +
                               " towards " + thing_of(words) + "\"?"
                         : "say left, right, up, down, closer or away, or \"towards the window\"");
  }
  if (!std::regex_match(text, match, to_a_thing())) return;
  const std::string thing = thing_of(match[2].str());
  throw_usage("\"" + match[2].str() + "\" does not tell how far the move goes",
              "give a length: \"move " + match[1].str() + " 0.5 m towards " + thing + "\"");
}

void refuse_side(const std::string& text) {
  std::smatch match;
  static const std::regex side("^(.*?\\S) +((?:over +)?to +the +(left|right)(?: +side)?)$", std::regex::icase);
  if (!std::regex_match(text, match, side)) return;
  const std::string name = std::regex_replace(match[1].str(), std::regex("^the +", std::regex::icase), "");
  throw_usage("\"" + match[2].str() + "\" does not tell how far away the copy is",
              "give a length: \"copy " + match[1].str() + " 0.5 m to the " + match[3].str() +
                  "\", or name the object: \"copy the " + match[3].str() + " " + name + "\"");
}

void require_motion(const ObjectMotion& motion) {
  if (!motion.stays_in_place() || std::fmod(motion.turn, kFullTurn) != 0) return;
  throw_usage("nothing would move: the motion is zero",
              "give a length above 0, or a turn that is no multiple of 360 degrees");
}

std::string motion_text(const ObjectMotion& motion) {
  if (motion.is_still()) return "";
  const Vec3d& s = motion.shift;
  std::string text = fmt::format(" by {:.9g},{:.9g},{:.9g}", s.x, s.y, s.z);
  if (motion.turn != 0) text += fmt::format(" and turn by {:.9g}", motion.turn);
  return text;
}

}  // namespace aligngs
