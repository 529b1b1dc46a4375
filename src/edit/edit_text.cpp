#include "edit/edit_text.h"

#include <algorithm>
#include <optional>
#include <regex>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/color_names.h"
#include "edit/inserted_object.h"
#include "edit/motion_text.h"
#include "edit/spoken_edit.h"
#include "edit/turn_text.h"

namespace aligngs {
namespace {

constexpr size_t kLongestEdit = 4096;   // bytes, as a selection
constexpr size_t kLongestSpoken = 400;  // bytes: patterns recurse over each letter
constexpr const char* kExample = "for example \"delete pillow, cushion\" or \"recolor sofa to dark green\"";

constexpr std::pair<std::string_view, EditKind> kVerbs[] = {
    {"delete", EditKind::kDelete},    {"remove", EditKind::kDelete},      {"extract", EditKind::kExtract},
    {"keep", EditKind::kExtract},     {"move", EditKind::kMove},          {"push", EditKind::kMove},
    {"turn", EditKind::kMove},        {"rotate", EditKind::kMove},        {"duplicate", EditKind::kDuplicate},
    {"copy", EditKind::kDuplicate},   {"replace", EditKind::kReplace},    {"recolor", EditKind::kRecolor},
    {"recolour", EditKind::kRecolor}, {"paint", EditKind::kRecolor},      {"color", EditKind::kRecolor},
    {"colour", EditKind::kRecolor},   {"highlight", EditKind::kHighlight}};

/// Cuts `ending` off, whatever its case.
bool take_ending(std::string& text, std::string_view ending) {
  if (text.size() < ending.size() ||
      lower_case(text).compare(text.size() - ending.size(), ending.size(), ending) != 0) {
    return false;
  }
  text.resize(text.size() - ending.size());
  return true;
}

void trim(std::string& text) {
  while (!text.empty() && text.back() == ' ') text.pop_back();
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
}

/// Cuts the last word off.
std::string take_last_word(std::string& text) {
  const size_t blank = text.rfind(' ');
  const size_t begin = blank == std::string::npos ? 0 : blank + 1;
  const std::string word = text.substr(begin);
  text.resize(begin);
  trim(text);
  return word;
}

/// "--threshold X" anywhere, or "(threshold X)" at the end.
std::optional<std::string> take_threshold(std::string& text) {
  constexpr std::string_view kOption = "--threshold", kSpoken = "(threshold ";
  size_t at = lower_case(text).find(kOption);
  if (at != std::string::npos) {
    size_t begin = at + kOption.size();
    while (begin < text.size() && (text[begin] == ' ' || text[begin] == '=')) ++begin;
    const size_t end = std::min(text.find(' ', begin), text.size());
    const std::string value = text.substr(begin, end - begin);
    text.erase(at, end - at);
    return value;
  }
  at = lower_case(text).rfind(kSpoken);
  if (at == std::string::npos || text.back() != ')') return {};
  const std::string value = text.substr(at + kSpoken.size(), text.size() - 1 - at - kSpoken.size());
  text.resize(at);
  return value;
}

/// Whether the text says that the hole is filled, or that it is not; nothing where it says neither.
std::optional<bool> take_fill(std::string& text) {
  if (take_ending(text, kHoleFilled)) return true;
  if (take_ending(text, kHoleLeftOpen)) return false;
  static const std::regex spoken(
      "^(.*?\\S)(?: *,| +and| +but)? +(?:no[ -]fill(?:ing)?|without +(?:a +|any +)?fill(?:ing)?(?: +(?:it|the +hole))?|"
      "(?:do +not|don't) +fill(?: +(?:it|the +hole))?|leave +the +hole(?: +open)?)$",
      std::regex::icase);
  std::smatch match;
  if (text.size() < kLongestSpoken && text.find("--") == std::string::npos && std::regex_match(text, match, spoken)) {
    text = std::string(match[1].str());
    return false;
  }
  for (const auto& [option, value] : {std::pair<std::string_view, bool>{"--no-fill", false}, {"--fill", true}}) {
    const size_t at = lower_case(text).find(option);
    if (at == std::string::npos) continue;
    text.erase(at, option.size());
    return value;
  }
  return {};
}

bool take_contents(std::string& text) {
  if (take_ending(text, kWithContents)) return true;
  static const std::regex spoken(
      R"(^(.*?\S) +(?:with|and|including|(?:together|along) with) +)"
      R"((?:(?:(?:all )?(?:of )?(?:its|their|the) )?contents|(?:everything|all|what(?:ever| is|'s)?|all that is|the things) +on +(?:it|them|top))$)",
      std::regex::icase);
  std::smatch match;
  if (text.size() < kLongestSpoken && std::regex_match(text, match, spoken)) {
    text = std::string(match[1].str());
    return true;
  }
  constexpr std::string_view kOption = "--with-contents";
  const size_t at = lower_case(text).find(kOption);
  if (at == std::string::npos) return false;
  text.erase(at, kOption.size());
  return true;
}

/// Takes the motion of "move", "turn" or "duplicate" off the end.
void read_motion(const std::string& verb, EditOperation& edit, std::string& text) {
  if (verb == "turn" || verb == "rotate") {
    const auto turn = take_turn(text);
    if (!turn) throw_usage("the turn has no angle", "for example \"turn armchair by 90\"");
    edit.motion.turn = *turn;
    return require_motion(edit.motion);
  }
  if (const auto motion = take_motion(text)) {
    edit.motion = *motion;
    require_motion(edit.motion);
  } else if (edit.kind == EditKind::kMove) {
    refuse_place(text);
    throw_usage("the move has no distance",
                "for example \"move sofa by 0.5,0,-0.2\" or \"move chair 0.5 m to the left\"");
  } else {
    refuse_side(text);
  }
}

/// Takes " with SOURCE, fitted, up -y and turn by 90" off a replacement.
void read_source(EditOperation& edit, std::string& text) {
  constexpr std::string_view kWith = " with ";
  size_t at = text.find(kWith);
  while (at != std::string::npos &&
         lower_case(text).compare(at, kWithContents.size() + 1, std::string(kWithContents) + " ") == 0)
    at = text.find(kWith, at + kWith.size());
  if (at == std::string::npos) {
    throw_usage("the replacement has no object",
                "for example \"replace armchair with chair.ply\" or \"replace sofa with other_run#sofa#1\"");
  }
  edit.with = text.substr(at + kWith.size());
  text.resize(at);
  const auto take_value = [&](std::string_view before) -> std::optional<std::string> {
    const size_t place = lower_case(edit.with).rfind(before);
    if (place == std::string::npos) return {};
    std::string value = edit.with.substr(place + before.size());
    edit.with.resize(place);
    trim(value);
    return value;
  };
  if (const auto turn = take_value(kAndTurn)) edit.motion.turn = parse_turn(*turn);
  if (const auto up = take_value(kUpwards)) edit.up_axis = parse_axis(*up);
  edit.fit = take_ending(edit.with, kFitted);
  trim(edit.with);
  if (edit.with.empty()) throw_usage("the replacement has no object", "name FILE.ply or RUN#OBJECT after \"with\"");
}

}  // namespace

std::vector<std::string> edit_verbs() {
  std::vector<std::string> verbs;
  for (const auto& [verb, kind] : kVerbs) verbs.emplace_back(verb);
  return verbs;
}

EditRequest parse_request(std::string_view given) {
  EditRequest request;
  request.undo = parse_undo(without_courtesy(std::string(given.substr(0, kLongestEdit))));
  if (!request.undo) request.edit = parse_edit(given);
  return request;
}

EditOperation parse_edit(std::string_view given) {
  if (given.size() > kLongestEdit) throw_usage("the edit is longer than 4096 bytes", kExample);
  std::string text(given);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  trim(text);
  text = plain_edit(std::move(text));
  trim(text);
  const size_t verb_end = std::min(text.find(' '), text.size());
  std::string verb = lower_case(text.substr(0, verb_end));
  if (verb.rfind("--", 0) == 0) verb.erase(0, 2);
  const auto* known =
      std::find_if(std::begin(kVerbs), std::end(kVerbs), [&](const auto& v) { return v.first == verb; });
  if (known == std::end(kVerbs)) {
    throw_usage(verb.empty() ? "there is no edit" : "\"" + verb.substr(0, 40) + "\" is no edit",
                std::string("say delete, extract, move, turn, duplicate, replace, recolor or highlight, ") + kExample);
  }
  EditOperation edit;
  edit.kind = known->second;
  text.erase(0, verb_end);
  const std::optional<bool> fill = take_fill(text);
  edit.fill = fill.value_or(true) && leaves_hole(edit.kind);
  trim(text);
  if (edit.kind == EditKind::kReplace) read_source(edit, text);
  // The motion is at the end, and the contents before or after it.
  edit.with_contents = edit.kind != EditKind::kReplace && take_contents(text);
  trim(text);
  if (edit.kind == EditKind::kMove || edit.kind == EditKind::kDuplicate) read_motion(verb, edit, text);
  edit.with_contents |= take_contents(text);
  trim(text);
  if (const auto threshold = take_threshold(text)) edit.threshold = parse_threshold(*threshold);
  trim(text);
  if (edit.with_contents && takes_color(edit.kind)) {
    throw_usage("the contents of an object are deleted, extracted or moved with it", "leave out \"with contents\"");
  }
  if (fill && !leaves_hole(edit.kind)) {
    throw_usage("--fill closes the hole that a deletion leaves", "use it with delete, move or replace");
  }
  if (edit.kind == EditKind::kRecolor || edit.kind == EditKind::kHighlight) {
    if (const auto color = take_color(text)) {
      edit.color = *color;
    } else if (edit.kind == EditKind::kRecolor) {
      if (text.find(' ') == std::string::npos)
        throw_usage("the edit names no colour, or no object", "for example \"recolor sofa to dark green\"");
      read_color(take_last_word(text));  // says what is wrong with it
    }
  }
  if (text.empty()) throw_usage("the edit names no object", kExample);
  edit.select = text;
  return edit;
}

}  // namespace aligngs
