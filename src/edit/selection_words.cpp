#include "edit/selection_words.h"

#include <algorithm>
#include <charconv>
#include <tuple>

#include "core/letter_case.h"
#include "edit/relation/relation_words.h"
#include "edit/vocabulary.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr int kLargestInstance = 65535;  // ushort in scene.labels.ply

constexpr std::string_view kQuantifiers[] = {"all of the",
                                             "all of my",
                                             "all of these",
                                             "all of those",
                                             "each of the",
                                             "each and every",
                                             "every one of the",
                                             "every single",
                                             "both of the",
                                             "all the",
                                             "all my",
                                             "all these",
                                             "all those",
                                             "both the",
                                             "all",
                                             "every",
                                             "each",
                                             "both",
                                             "any",
                                             "my",
                                             "our",
                                             "your",
                                             "this",
                                             "that",
                                             "these",
                                             "those"};

constexpr std::pair<std::string_view, ObjectChoice> kChoices[] = {
    {"largest", ObjectChoice::kLargest},     {"biggest", ObjectChoice::kLargest},
    {"smallest", ObjectChoice::kSmallest},   {"larger", ObjectChoice::kLargest},
    {"bigger", ObjectChoice::kLargest},      {"smaller", ObjectChoice::kSmallest},
    {"large", ObjectChoice::kLargest},       {"big", ObjectChoice::kLargest},
    {"small", ObjectChoice::kSmallest},      {"left", ObjectChoice::kLeft},
    {"leftmost", ObjectChoice::kLeft},       {"left most", ObjectChoice::kLeft},
    {"right", ObjectChoice::kRight},         {"rightmost", ObjectChoice::kRight},
    {"right most", ObjectChoice::kRight},    {"highest", ObjectChoice::kHighest},
    {"topmost", ObjectChoice::kHighest},     {"top", ObjectChoice::kHighest},
    {"bottom", ObjectChoice::kLowest},       {"bottommost", ObjectChoice::kLowest},
    {"far left", ObjectChoice::kLeft},       {"far right", ObjectChoice::kRight},
    {"furthest left", ObjectChoice::kLeft},  {"furthest right", ObjectChoice::kRight},
    {"huge", ObjectChoice::kLargest},        {"little", ObjectChoice::kSmallest},
    {"tiny", ObjectChoice::kSmallest},       {"highest up", ObjectChoice::kHighest},
    {"long", ObjectChoice::kWidest},         {"upper", ObjectChoice::kHighest},
    {"uppermost", ObjectChoice::kHighest},   {"lowest", ObjectChoice::kLowest},
    {"lower", ObjectChoice::kLowest},        {"tallest", ObjectChoice::kTallest},
    {"taller", ObjectChoice::kTallest},      {"tall", ObjectChoice::kTallest},
    {"shortest", ObjectChoice::kShortest},   {"shorter", ObjectChoice::kShortest},
    {"short", ObjectChoice::kShortest},      {"widest", ObjectChoice::kWidest},
    {"wider", ObjectChoice::kWidest},        {"wide", ObjectChoice::kWidest},
    {"longest", ObjectChoice::kWidest},      {"longer", ObjectChoice::kWidest},
    {"narrowest", ObjectChoice::kNarrowest}, {"narrower", ObjectChoice::kNarrowest},
    {"narrow", ObjectChoice::kNarrowest},    {"middle", ObjectChoice::kMiddle},
    {"middlemost", ObjectChoice::kMiddle},   {"central", ObjectChoice::kMiddle},
    {"centre", ObjectChoice::kMiddle},       {"center", ObjectChoice::kMiddle},
    {"darkest", ObjectChoice::kDarkest},     {"darker", ObjectChoice::kDarkest},
    {"dark", ObjectChoice::kDarkest},        {"lightest", ObjectChoice::kLightest},
    {"lighter", ObjectChoice::kLightest},    {"brightest", ObjectChoice::kLightest},
    {"brighter", ObjectChoice::kLightest},   {"light", ObjectChoice::kLightest},
    {"bright", ObjectChoice::kLightest},     {"pale", ObjectChoice::kLightest}};

constexpr std::pair<std::string_view, ObjectChoice> kPlaces[] = {
    {" on the left", ObjectChoice::kLeft},          {" to the left", ObjectChoice::kLeft},
    {" on the left side", ObjectChoice::kLeft},     {" on the right", ObjectChoice::kRight},
    {" to the right", ObjectChoice::kRight},        {" on the right side", ObjectChoice::kRight},
    {" furthest to the left", ObjectChoice::kLeft}, {" furthest to the right", ObjectChoice::kRight},
    {" at the left", ObjectChoice::kLeft},          {" at the right", ObjectChoice::kRight},
    {" in the middle", ObjectChoice::kMiddle},      {" in the centre", ObjectChoice::kMiddle},
    {" in the center", ObjectChoice::kMiddle},      {" at the top", ObjectChoice::kHighest},
    {" at the bottom", ObjectChoice::kLowest}};

constexpr std::string_view kBoth[] = {"both of the", "both the", "both"};
constexpr std::string_view kBeforeCounts[] = {"all of the", "all the", "all", "the", "these", "those", "my"};
/// Words between a thing and its place, the last one first.
constexpr std::string_view kFillers[] = {"standing", "lying",   "sitting", "hanging", "placed",   "located", "is",
                                         "are",      "stands",  "stand",   "lies",    "lie",      "hangs",   "hang",
                                         "sits",     "sit",     "that",    "which",   "directly", "just",    "right",
                                         "hung",     "mounted", "leaning", "resting", "sat"};

/// Longer ones before those that they begin with.
constexpr std::string_view kConjunctions[] = {"as well as", "and", "or", "&", "+", "plus"};
constexpr std::string_view kExceptions[] = {"except for",    "except",       "but",        "without",
                                            "excluding",     "apart from",   "aside from", "save for",
                                            "other than",    "minus",        "save",       "with the exception of",
                                            "not including", "not counting", "leaving out"};

constexpr std::string_view kNumbers[] = {"one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"};
constexpr std::string_view kOrdinals[] = {"first", "second",  "third",  "fourth", "fifth",
                                          "sixth", "seventh", "eighth", "ninth",  "tenth"};
constexpr std::string_view kOrdinalEnds[] = {"st", "nd", "rd", "th"};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

int number_of(std::string_view text) {
  text = trimmed(text);
  for (const std::string_view prefix : {"number ", "no. ", "no ", "nr. "}) {
    if (lower_case(text.substr(0, prefix.size())) == prefix) text = trimmed(text.substr(prefix.size()));
  }
  if (!text.empty() && text.front() == '#') text.remove_prefix(1);
  for (size_t i = 0; i < std::size(kNumbers); ++i) {
    if (lower_case(text) == kNumbers[i]) return static_cast<int>(i) + 1;
  }
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error != std::errc() || end != text.data() + text.size() || n < 1 || n > kLargestInstance ? 0 : n;
}

/// The first of `words` in `text`; of two at one place the one that comes first in `words`.
template <class Words>
std::pair<size_t, size_t> find_first(std::string_view text, const Words& words, size_t from) {
  std::pair<size_t, size_t> found{std::string_view::npos, 0};
  for (const std::string_view word : words) {
    const size_t at = find_word(text, word, from);
    if (at < found.first) found = {at, word.size()};
  }
  return found;
}

/// "All lamps, not lamp#2" and "all lamps and not lamp#2". "Not on the bed" is a place.
std::pair<size_t, size_t> find_not(std::string_view text) {
  for (const std::string_view word : {"and not", "not"}) {
    const size_t at = find_word(text, word, 1);
    if (at == std::string_view::npos || find_relation(trimmed(text.substr(at + word.size())), true)) continue;
    const std::string_view before = trimmed(text.substr(0, at));
    if (word != "not" || (!before.empty() && before.back() == ',')) return {at, word.size()};
  }
  return {std::string_view::npos, 0};
}

}  // namespace

std::string choice_word(ObjectChoice choice) {
  for (const auto& [word, known] : kChoices) {
    if (known == choice) return std::string(word);
  }
  return "";
}

bool take_phrase(std::string_view& item, std::string_view phrase) {
  if (item.size() <= phrase.size() || !is_blank(item[phrase.size()])) return false;
  if (lower_case(item.substr(0, phrase.size())) != phrase) return false;
  item = trimmed(item.substr(phrase.size()));
  return !item.empty();
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

std::pair<size_t, size_t> find_conjunction(std::string_view text, size_t from) {
  return find_first(text, kConjunctions, from);
}

std::pair<size_t, size_t> find_exception(std::string_view text) {
  auto [at, length] = find_first(text, kExceptions, 0);
  if (at == std::string_view::npos) std::tie(at, length) = find_not(text);
  if (at == std::string_view::npos) return {at, 0};
  constexpr std::string_view kNot = "not";  // "every lamp but not lamp#2"
  const size_t next = text.find_first_not_of(" \t\r\n", at + length);
  if (next != std::string_view::npos && find_word(text, kNot, next) == next) length = next + kNot.size() - at;
  return {at, length};
}

std::string_view without_a(std::string_view item) {
  item = trimmed(item);
  for (const std::string_view article : {"a", "an", "one"}) {
    if (take_phrase(item, article)) break;
  }
  return item;
}

std::string_view without_quantifier(std::string_view item) {
  item = trimmed(item);
  for (const std::string_view quantifier : kQuantifiers) {
    if (take_phrase(item, quantifier)) break;
  }
  return item;
}

bool begins_with_quantifier(std::string_view item) {
  item = trimmed(item);
  const auto begins = [&](std::string_view quantifier) {
    constexpr std::string_view kOfOne[] = {"my", "our", "your", "this", "that"};
    return std::find(std::begin(kOfOne), std::end(kOfOne), quantifier) == std::end(kOfOne) &&
           take_phrase(item, quantifier);
  };
  return std::any_of(std::begin(kQuantifiers), std::end(kQuantifiers), begins);
}

ObjectChoice take_place(std::string_view& item) {
  const std::string low = lower_case(trimmed(item));
  const std::pair<std::string_view, ObjectChoice>* longest = nullptr;
  for (const auto& place : kPlaces) {
    if (low.size() <= place.first.size() || !low.ends_with(place.first)) continue;
    if (!longest || place.first.size() > longest->first.size()) longest = &place;
  }
  if (!longest) return ObjectChoice::kNone;
  item = trimmed(item);
  item = trimmed(item.substr(0, item.size() - longest->first.size()));
  for (const std::string_view filler : {" that is", " which is", " that are", " which are"}) {
    if (item.size() > filler.size() && lower_case(item).ends_with(filler))
      item = trimmed(item.substr(0, item.size() - filler.size()));
  }
  return longest->second;
}

int take_count(std::string_view& item) {
  std::string_view rest = trimmed(item);
  for (const std::string_view both : kBoth) {
    if (!take_phrase(rest, both)) continue;
    item = rest;
    return 2;
  }
  for (const std::string_view before : kBeforeCounts) {
    if (take_phrase(rest, before)) break;
  }
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
  const int count = word.size() == rest.size() || word.front() == '#' ? 0 : number_of(word);
  if (count > 0) item = trimmed(rest.substr(word.size()));
  return count;
}

std::string_view without_filler(std::string_view item) {
  item = trimmed(item);
  for (size_t length = 0; length != item.size();) {
    length = item.size();
    for (const std::string_view filler : kFillers) {
      if (item.size() <= filler.size() + 1 || !lower_case(item).ends_with(filler)) continue;
      const std::string_view rest = item.substr(0, item.size() - filler.size());
      if (is_blank(rest.back())) item = trimmed(rest);
    }
  }
  return item;
}

ObjectChoice take_choice(std::string_view& item) {
  std::string_view words = trimmed(item), shortest = words;
  take_phrase(words, "the");
  ObjectChoice found = ObjectChoice::kNone;
  for (const auto& [word, choice] : kChoices) {  // the longest one: "far left"
    std::string_view rest = words;
    if (!take_phrase(rest, word) || rest.size() >= shortest.size()) continue;
    shortest = rest;
    found = choice;
  }
  if (found != ObjectChoice::kNone) item = shortest;
  return found;
}

int ordinal_number(std::string_view given) {
  const std::string word = lower_case(given);
  for (size_t i = 0; i < std::size(kOrdinals); ++i) {
    if (word == kOrdinals[i]) return static_cast<int>(i) + 1;
  }
  for (const std::string_view end : kOrdinalEnds) {
    if (word.size() <= end.size() || !word.ends_with(end)) continue;
    const std::string digits = word.substr(0, word.size() - end.size());
    return digits.find_first_not_of("0123456789") == std::string::npos ? number_of(digits) : 0;
  }
  return 0;
}

std::string ordinal_text(int number) {
  const int tens = number / 10 % 10, ones = number % 10;
  const size_t end = tens == 1 || ones < 1 || ones > 3 ? 3 : static_cast<size_t>(ones) - 1;
  return std::to_string(number) + std::string(kOrdinalEnds[end]);
}

int take_ordinal(std::string_view& item) {
  std::string_view rest = trimmed(item);
  take_phrase(rest, "the");
  const std::string word = lower_case(rest.substr(0, rest.find_first_of(" \t-")));
  const int number = ordinal_number(word);
  if (number == 0) return 0;
  const bool hyphen = rest.size() > word.size() + 1 && rest[word.size()] == '-';  // "second-largest"
  if (hyphen)
    rest = trimmed(rest.substr(word.size() + 1));
  else if (!take_phrase(rest, word))
    return 0;
  item = rest;
  return number;
}

std::pair<int, int> object_numbers(std::string_view text) {
  size_t part = text.find('-'), width = 1;
  constexpr std::string_view kLongDash = "\xe2\x80\x93";
  if (const size_t at = text.find(kLongDash); at < part) std::tie(part, width) = std::pair(at, kLongDash.size());
  for (const std::string_view word : {"to", "through"}) {
    if (const size_t at = find_word(text, word); at < part) std::tie(part, width) = std::pair(at, word.size());
  }
  if (part == std::string_view::npos) {
    const int n = number_of(text);
    return {n, n};
  }
  const int first = number_of(text.substr(0, part)), last = number_of(text.substr(part + width));
  return first == 0 || last < first ? std::pair(0, 0) : std::pair(first, last);
}

}  // namespace aligngs
