#include "edit/turn_text.h"

#include <fmt/format.h>

#include <regex>

#include "core/letter_case.h"
#include "edit/motion_text.h"

namespace aligngs {
namespace {

constexpr const char* kTurnSide =
    "(counter-?clockwise|anti-?clockwise|clockwise|ccw|acw|cw|(?:to +the +)?(?:left|right))";

const std::regex& by_degrees() {
  static const std::regex pattern(
      fmt::format("^(.*?\\S)( +by)? +([-+.,0-9]+(?:e[-+]?[0-9]+)?)( *degrees?| *deg| *\xc2\xb0)?( +{})?$", kTurnSide),
      std::regex::icase);
  return pattern;
}

}  // namespace

std::optional<double> take_turn(std::string& text) {
  std::smatch match;
  static const std::regex side_first(  // "on the left" is of the object
      "^(.*?\\S) +(counter-?clockwise|anti-?clockwise|clockwise|ccw|acw|cw|to +the +(?:left|right))(?: +by)? "
      "+([-+.,0-9]+(?: *degrees?| *deg| *\xc2\xb0)?)$",
      std::regex::icase);
  if (std::regex_match(text, match, side_first))
    text = match[1].str() + " " + match[3].str() + " " + match[2].str();  // "anticlockwise by 30 degrees"
  static const std::regex part_of_a_turn(
      fmt::format(
          "^(.*?\\S)(?: +by)? +(a +quarter(?: +of +a)?|a +half|half +an?|one +quarter|quarter|half|"
          "(?:a +)?three[- ]+quarters?(?: +of +a)?|1/2(?: +an?)?|[13]/4(?: +of +a)?)(?: +turn| +circle)?( +{})?$",
          kTurnSide),
      std::regex::icase);
  if (std::regex_match(text, match, part_of_a_turn)) {
    const std::string part = lower_case(match[2].str());
    const auto says = [&](const char* word) { return part.find(word) != std::string::npos; };
    const double degrees = says("half") || says("1/2") ? 180 : says("three") || says("3/4") ? 270 : 90;
    text = match[1].str() + fmt::format(" by {:.0f}", degrees) + match[3].str();
  }
  if (!std::regex_match(text, match, by_degrees())) return {};
  const double turn = parse_turn(match[3].str());
  const std::string side = lower_case(match[6].str());  // a turn to the left is counter-clockwise
  const bool clockwise = side == "clockwise" || side == "cw" || side.ends_with("right");
  text = std::string(match[1].str());
  return clockwise ? -turn : turn;
}

}  // namespace aligngs
