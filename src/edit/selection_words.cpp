#include "edit/selection_words.h"

#include <algorithm>
#include <charconv>

#include "edit/vocabulary.h"

namespace aligngs {
namespace {

constexpr int kLargestInstance = 65535;  // ushort in scene.labels.ply

constexpr std::string_view kQuantifiers[] = {
    "all of the", "each of the", "every one of the", "both of the", "all the", "both the", "all", "every", "each",
    "both",       "any"};

constexpr std::pair<std::string_view, ObjectChoice> kChoices[] = {
    {"largest", ObjectChoice::kLargest},   {"biggest", ObjectChoice::kLargest}, {"smallest", ObjectChoice::kSmallest},
    {"left", ObjectChoice::kLeft},         {"leftmost", ObjectChoice::kLeft},   {"left most", ObjectChoice::kLeft},
    {"right", ObjectChoice::kRight},       {"rightmost", ObjectChoice::kRight}, {"right most", ObjectChoice::kRight},
    {"highest", ObjectChoice::kHighest},   {"topmost", ObjectChoice::kHighest}, {"upper", ObjectChoice::kHighest},
    {"uppermost", ObjectChoice::kHighest}, {"lowest", ObjectChoice::kLowest},   {"lower", ObjectChoice::kLowest}};

constexpr std::pair<std::string_view, ObjectChoice> kPlaces[] = {{" on the left", ObjectChoice::kLeft},
                                                                 {" on the right", ObjectChoice::kRight}};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Takes the words of `phrase` off the begin of `item` where more follows.
bool take_phrase(std::string_view& item, std::string_view phrase) {
  if (item.size() <= phrase.size() || !is_blank(item[phrase.size()])) return false;
  if (lower_case(item.substr(0, phrase.size())) != phrase) return false;
  item = trimmed(item.substr(phrase.size()));
  return !item.empty();
}

int number_of(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '#') text.remove_prefix(1);
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error != std::errc() || end != text.data() + text.size() || n < 1 || n > kLargestInstance ? 0 : n;
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

std::string choice_word(ObjectChoice choice) {
  for (const auto& [word, known] : kChoices) {
    if (known == choice) return std::string(word);
  }
  return "";
}

std::string_view trimmed(std::string_view text) {
  const char* blanks = " \t\r\n";
  const size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

size_t find_word(std::string_view text, std::string_view word, size_t from) {
  const std::string low = lower_case(text);
  for (size_t at = low.find(word, from); at != std::string::npos; at = low.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at == 0 || is_blank(low[at - 1]) || low[at - 1] == ',') &&
        (end == low.size() || is_blank(low[end]) || low[end] == ',')) {
      return at;
    }
  }
  return std::string::npos;
}

std::string_view without_quantifier(std::string_view item) {
  item = trimmed(item);
  for (const std::string_view quantifier : kQuantifiers) {
    if (take_phrase(item, quantifier)) break;
  }
  return item;
}

ObjectChoice take_choice(std::string_view& item) {
  std::string_view rest = trimmed(item);
  take_phrase(rest, "the");
  for (const auto& [ending, choice] : kPlaces) {
    if (rest.size() <= ending.size() || lower_case(rest.substr(rest.size() - ending.size())) != ending) continue;
    item = trimmed(rest.substr(0, rest.size() - ending.size()));
    return choice;
  }
  for (const auto& [word, choice] : kChoices) {
    if (!take_phrase(rest, word)) continue;
    item = rest;
    return choice;
  }
  return ObjectChoice::kNone;
}

std::pair<int, int> object_numbers(std::string_view text) {
  const size_t dash = text.find('-'), word = find_word(text, "to");
  const size_t part = std::min(dash, word), width = part == dash ? 1 : 2;
  if (part == std::string_view::npos) {
    const int n = number_of(text);
    return {n, n};
  }
  const int first = number_of(text.substr(0, part)), last = number_of(text.substr(part + width));
  return first == 0 || last < first ? std::pair(0, 0) : std::pair(first, last);
}

}  // namespace aligngs
