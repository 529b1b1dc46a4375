#include "edit/spoken_edit.h"

#include <regex>
#include <utility>
#include <vector>

#include "edit/color_names.h"

namespace aligngs {
namespace {

struct Phrase {
  std::regex pattern;  ///< of the whole sentence, any case
  const char* plain;
};

/// The first one that fits is taken.
const std::vector<Phrase>& phrases() {
  const auto any_case = [](const char* pattern) { return std::regex(pattern, std::regex::icase); };
  static const std::vector<Phrase> all = {
      {any_case("(?:get rid of|dispose of|take away|throw (?:out|away)|clear away|wipe out|strip out|hide|erase|lose|"
                "discard|eliminate) +(\\S.*)"),
       "delete $1"},
      {any_case("drop +(\\S.*\\S) +by +([0-9]\\S*(?: *[a-z]+)?)(?: +down)?"), "move $1 $2 down"},
      {any_case("drop +(\\S.*\\S) +([0-9][0-9.,]* *(?:m|cm|mm|inch|inches|ft|foot|feet))(?: +down)?"),
       "move $1 $2 down"},
      {any_case("drop +((?!.* (?:on|onto|in|into|to|down|at|by|off) )\\S.*)"), "delete $1"},
      {any_case("(?:spin|swivel|revolve|pivot) +(\\S.*\\S) +(?:around|round)"), "turn $1 by 180"},
      {any_case("(?:spin|swivel|revolve|pivot) +(\\S.*)"), "turn $1"},
      {any_case("clear +(\\S.*)"), "delete everything on $1"},
      {any_case("empty(?: +out)? +(\\S.*)"), "delete everything in $1"},
      {any_case("(?:take|remove) +(\\S.*\\S) +(?:off|from)(?: +of)? +(\\S.*)"), "delete $1 on $2"},
      {any_case("(?:take|throw) +(\\S.*\\S) +(?:away|out(?: +of +(?:the|my) +room)?)"), "delete $1"},
      {any_case("make +(\\S.*\\S) +(?:disappear|vanish|go away)"), "delete $1"},
      {any_case("(?:show|keep|leave) +(?:me +)?(?:only|just) +(\\S.*)"), "keep $1"},
      {any_case("only +(?:show|keep|leave) +(\\S.*)"), "keep $1"},
      {any_case("(?:show|keep|leave) +(\\S.*\\S) +only"), "keep $1"},
      {any_case("isolate +(\\S.*)"), "keep $1"},
      {any_case("(?:lift|raise) +(\\S.*\\S)(?: +up)?(?: +by)? +([0-9]\\S*(?: *[a-z]+)?)"), "move $1 $2 up"},
      {any_case("lower +(\\S.*\\S)(?: +by)? +([0-9]\\S*(?: *[a-z]+)?)"), "move $1 $2 down"},
      {any_case("clone +(\\S.*)"), "copy $1"},
      {any_case("(?:make|create) +(?:a +copy|a +duplicate|a +clone|another +copy) +of +(\\S.*)"), "copy $1"},
      {any_case("(?:swap|exchange|substitute) +(\\S.*?\\S) +(?:for|with|by) +(\\S.*)"), "replace $1 with $2"},
      {any_case("replace +((?:(?! with ).)*?\\S) +by +(\\S.*)"), "replace $1 with $2"},
      {any_case("(?:change|set) +(?:the +)?colou?r +of +(\\S.*\\S) +(?:in)?to +(\\S.*)"), "recolor $1 to $2"},
      {any_case("(?:put|shift|slide|pull|nudge|drag) +(\\S.*)"), "move $1"},
      {any_case("(turn|rotate) +(\\S.*\\S) +(?:around|round)"), "$1 $2 by 180"}};
  return all;
}

/// "Make X dark green" and "change X to red" for "recolor X dark green".
std::string with_color_verb(const std::string& text) {
  static const std::regex pattern("^(?:make|turn|dye|change|tint) +(\\S.*)$", std::regex::icase);
  std::smatch match;
  if (!std::regex_match(text, match, pattern)) return text;
  std::string object = match[1].str();
  return take_color(object) && !object.empty() ? "recolor " + match[1].str() : text;
}

}  // namespace

std::string without_courtesy(std::string text) {
  static const std::regex before(
      "^(?:please|(?:could|can|would|will) you|i (?:want|would like|'d like)(?: you)? to|i'd like(?: you)? to|now)[ "
      ",]+",
      std::regex::icase);
  static const std::regex after("[ ,]+please$|[ ?.!]+$", std::regex::icase);
  for (size_t length = 0; length != text.size();) {
    length = text.size();
    text = std::regex_replace(text, before, "", std::regex_constants::format_first_only);
    text = std::regex_replace(text, after, "", std::regex_constants::format_first_only);
  }
  return text;
}

std::string plain_edit(std::string text) {
  constexpr size_t kLongestSpoken = 400;  // bytes: longer texts are lists, and the patterns recurse over each letter
  if (text.size() > kLongestSpoken) return text;
  text = without_courtesy(std::move(text));
  for (const Phrase& phrase : phrases()) {
    if (!std::regex_match(text, phrase.pattern)) continue;
    text = std::regex_replace(text, phrase.pattern, phrase.plain);
    break;
  }
  static const std::regex half("\\bhalf an? +(?=met(?:re|er)|foot)", std::regex::icase);
  static const std::regex one("\\b(?:one|an?) +(?=met(?:re|er)|foot\\b)", std::regex::icase);
  text = std::regex_replace(text, half, "0.5 ");
  text = std::regex_replace(text, one, "1 ");
  return with_color_verb(text);
}

}  // namespace aligngs
