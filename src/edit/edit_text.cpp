#include "edit/edit_text.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr size_t kLongestEdit = 4096;  // bytes, as a selection
constexpr const char* kExample = "for example \"delete pillow, cushion\" or \"recolor sofa to #add8e6\"";

constexpr std::pair<std::string_view, EditKind> kVerbs[] = {
    {"delete", EditKind::kDelete},   {"remove", EditKind::kDelete},    {"extract", EditKind::kExtract},
    {"keep", EditKind::kExtract},    {"recolor", EditKind::kRecolor},  {"recolour", EditKind::kRecolor},
    {"highlight", EditKind::kHighlight}};

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

/// Cuts `ending` off, whatever its case.
bool take_ending(std::string& text, std::string_view ending) {
  if (text.size() < ending.size() || lower(text).compare(text.size() - ending.size(), ending.size(), ending) != 0) {
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
  size_t at = lower(text).find(kOption);
  if (at != std::string::npos) {
    size_t begin = at + kOption.size();
    while (begin < text.size() && (text[begin] == ' ' || text[begin] == '=')) ++begin;
    const size_t end = std::min(text.find(' ', begin), text.size());
    const std::string value = text.substr(begin, end - begin);
    text.erase(at, end - at);
    return value;
  }
  at = lower(text).rfind(kSpoken);
  if (at == std::string::npos || text.back() != ')') return {};
  const std::string value = text.substr(at + kSpoken.size(), text.size() - 1 - at - kSpoken.size());
  text.resize(at);
  return value;
}

bool take_fill(std::string& text) {
  if (take_ending(text, ", hole filled")) return true;
  const size_t at = lower(text).find("--fill");
  if (at == std::string::npos) return false;
  text.erase(at, std::string_view("--fill").size());
  return true;
}

}  // namespace

EditOperation parse_edit(std::string_view given) {
  if (given.size() > kLongestEdit) throw_usage("the edit is longer than 4096 bytes", kExample);
  std::string text(given);
  std::replace_if(text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  trim(text);
  const size_t verb_end = std::min(text.find(' '), text.size());
  std::string verb = lower(text.substr(0, verb_end));
  if (verb.rfind("--", 0) == 0) verb.erase(0, 2);
  const auto* known = std::find_if(std::begin(kVerbs), std::end(kVerbs), [&](const auto& v) { return v.first == verb; });
  if (known == std::end(kVerbs)) {
    throw_usage(verb.empty() ? "there is no edit" : "\"" + verb.substr(0, 40) + "\" is no edit",
                std::string("say delete, extract, recolor or highlight, ") + kExample);
  }
  EditOperation edit;
  edit.kind = known->second;
  text.erase(0, verb_end);
  edit.fill = take_fill(text);
  trim(text);
  if (const auto threshold = take_threshold(text)) edit.threshold = parse_threshold(*threshold);
  trim(text);
  if (edit.fill && edit.kind != EditKind::kDelete) {
    throw_usage("--fill closes the hole that a deletion leaves", "use it with delete");
  }
  const bool colored = edit.kind == EditKind::kRecolor || edit.kind == EditKind::kHighlight;
  const bool names_color = text.rfind(" #") != std::string::npos && text.rfind(" #") == text.rfind(' ');
  if (colored && (names_color || edit.kind == EditKind::kRecolor)) {
    edit.color = parse_color(take_last_word(text));
    std::string rest = text;
    const std::string preposition = lower(take_last_word(rest));
    if (preposition == "to" || preposition == "in" || preposition == "with") text = rest;
  }
  if (text.empty()) throw_usage("the edit names no object", kExample);
  edit.select = text;
  return edit;
}

}  // namespace aligngs
