#include "edit/plain_words.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/item_adjectives.h"
#include "edit/relation/relation_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

using WordPair = std::pair<std::string_view, std::string_view>;

/// Whole words, wherever they are.
constexpr WordPair kOthers[] = {{"that's", "that is"},
                                {"what's", "what is"},
                                {"isn't", "is not"},
                                {"aren't", "are not"},
                                {"left-hand", "left"},
                                {"right-hand", "right"},
                                {"left hand", "left"},
                                {"right hand", "right"},
                                {"on the far left", "on the left"},
                                {"on the far right", "on the right"},
                                {"in the centre of the room", "in the middle of the room"},
                                {"in the center of the room", "in the middle of the room"},
                                {"in the corner of the room", "in the corner"},
                                {"with its", "with the"},
                                {"with their", "with the"},
                                {"a pair of", "both"},
                                {"the pair of", "both"},
                                {"the couple of", "both"},
                                {"the contents of", "everything in"},
                                {"contents of", "everything in"}};

constexpr std::string_view kOfTheRoom[] = {" in the room", " in this room", " in my room", " of the room", " in here"};

void replace_words(std::string& text, std::string_view from, std::string_view to) {
  for (size_t at = find_word(text, from); at != std::string::npos; at = find_word(text, from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// "Everything in the room" are the things in it, and "the lamp in the room" is the lamp.
void leave_out_room(std::string& text) {
  for (const std::string_view ending : kOfTheRoom) {
    if (text.size() <= ending.size() || !lower_case(text).ends_with(ending)) continue;
    const std::string rest = text.substr(0, text.size() - ending.size()), low = lower_case(rest);
    if (low.ends_with("middle")) return;
    const bool is_all = low == "everything" || low == "all" || low == "anything";
    text = is_all ? "all things" : rest;
    return;
  }
}

/// "The bed's pillows", and "the pillows of the bed".
void say_owner_last(std::string& text, const Vocabulary& vocabulary) {
  constexpr std::string_view kOwns = "'s ", kOf = " of ";
  const std::string belongs = " belonging to ";
  if (const size_t at = text.find(kOwns); at != std::string::npos) {
    const std::string owner = text.substr(0, std::min(at, text.find('#')));
    if (vocabulary.find(noun_of(owner, vocabulary)))
      text = "the " + text.substr(at + kOwns.size()) + belongs + text.substr(0, at);
    return;
  }
  for (size_t at = text.find(kOf); at != std::string::npos; at = text.find(kOf, at + 1)) {
    const std::string thing = text.substr(0, at), owner = text.substr(at + kOf.size());
    const bool is_one = begins_with_article(owner) && vocabulary.find(noun_of(owner, vocabulary)).has_value();
    if (!is_one || !vocabulary.find(noun_of(thing, vocabulary)) || vocabulary.find(text)) continue;
    if (vocabulary.is_plural(owner) || is_adjective_alone(thing, vocabulary)) continue;
    text = thing + belongs + owner;
    return;
  }
}

constexpr WordPair kOrders[] = {{"nearest", "nearest to"},
                                {"closest", "nearest to"},
                                {"farthest", "farthest from"},
                                {"furthest", "farthest from"},
                                {"most distant", "farthest from"}};

/// "The nearest lamp to the window" as "the lamp nearest to the window".
void say_order_last(std::string& text) {
  std::string_view rest = text;
  take_phrase(rest, "the");
  std::string_view after_number = rest;
  if (take_ordinal(after_number) == 0) take_count(after_number);
  const std::string number(trimmed(rest.substr(0, rest.size() - after_number.size())));
  for (const auto& [word, relation] : kOrders) {
    std::string_view name = after_number;
    if (!take_phrase(name, word)) continue;
    size_t at = std::string::npos, length = 0;
    for (const std::string_view join : {"away from", "from", "to"}) {
      const size_t place = find_word(name, join, 1);
      if (place < at) std::tie(at, length) = std::pair(place, join.size());
    }
    if (at == std::string::npos || trimmed(name.substr(at + length)).empty()) {
      if (find_relation(name)) return;  // "the furthest lamp on the left"
      throw_usage("\"" + std::string(word) + " " + std::string(name) + "\" does not tell " +
                      (relation == "nearest to" ? "to" : "from") + " what",
                  "say \"the " + std::string(name) + " " + std::string(relation) + " the door\", or name it by number");
    }
    text = "the " + (number.empty() ? "" : number + " ") + std::string(trimmed(name.substr(0, at))) + " " +
           std::string(relation) + " " + std::string(trimmed(name.substr(at + length)));
    return;
  }
}

/// "The corner chair" as "the chair in the corner".
void say_corner_last(std::string& text, const Vocabulary& vocabulary) {
  std::string_view rest = text;
  take_phrase(rest, "the");
  if (take_phrase(rest, "corner") && vocabulary.find(rest)) text = "the " + std::string(rest) + " in the corner";
}

/// "The lamp that is bigger" as "the bigger lamp".
void say_adjective_first(std::string& text, const Vocabulary& vocabulary) {
  for (const std::string_view join : {"that is", "which is"}) {
    const size_t at = find_word(text, join, 1);
    if (at == std::string::npos) continue;
    std::string_view thing = trimmed(std::string_view(text).substr(0, at));
    std::string_view adjective = trimmed(std::string_view(text).substr(at + join.size()));
    take_phrase(thing, "the");
    take_phrase(adjective, "the");
    if (!vocabulary.find(thing) || !is_adjective_alone(adjective, vocabulary)) continue;
    text = "the " + std::string(adjective) + " " + std::string(thing);
    return;
  }
}

/// "The table with the lamp on it" is the table that holds the lamp. Without "on it" both may be meant.
void say_holding(std::string& text, const Vocabulary& vocabulary) {
  const size_t with = find_word(text, "with", 1);
  const std::string low = lower_case(text);
  constexpr std::string_view kEndings[] = {" on top of it", " on top of them", " on top", " on it",
                                           " on them",      " in it",          " in them"};
  const auto ending =
      std::find_if(std::begin(kEndings), std::end(kEndings), [&](std::string_view e) { return low.ends_with(e); });
  const bool holds = find_word(text, "has") != std::string::npos || find_word(text, "have") != std::string::npos ||
                     find_word(text, "holding") != std::string::npos;
  if (with == std::string::npos && !holds) return;
  if (ending != std::end(kEndings)) text.resize(text.size() - ending->size());
  if (with == std::string::npos || !vocabulary.find(noun_of(std::string_view(text).substr(with + 4), vocabulary)))
    return;
  const std::string owner(trimmed(std::string_view(text).substr(0, with)));
  const std::string held(trimmed(std::string_view(text).substr(with + 4)));  // after "with"
  if (ending == std::end(kEndings))
    throw_usage("\"" + text + "\" has two readings",
                "did you mean \"" + owner + ", " + held + "\" or \"" + owner + " with " + held + " on it\"?");
  text = owner + " holding " + held;
}

}  // namespace

std::string in_plain_words(std::string_view item, const Vocabulary& vocabulary) {
  std::string text(trimmed(item));
  constexpr std::string_view kCurly = "\xe2\x80\x99";
  for (size_t at = text.find(kCurly); at != std::string::npos; at = text.find(kCurly)) text.replace(at, 3, "'");
  if (text.empty() || vocabulary.find(text) || vocabulary.find_selection(text)) return std::string(trimmed(item));
  for (const auto& [from, to] : kOthers) replace_words(text, from, to);
  leave_out_room(text);
  say_adjective_first(text, vocabulary);
  say_owner_last(text, vocabulary);
  say_order_last(text);
  if (!vocabulary.find(text)) say_corner_last(text, vocabulary);
  say_holding(text, vocabulary);
  return text;
}

std::string with_each_name(std::string_view item, const Vocabulary& vocabulary) {
  const std::string whole(trimmed(item));
  if (vocabulary.find(whole) || vocabulary.find_selection(whole)) return whole;
  std::vector<std::string> parts;
  for (std::string_view rest = whole;;) {
    const auto [at, length] = find_conjunction(rest, 1);
    parts.emplace_back(trimmed(rest.substr(0, at)));
    if (at == std::string_view::npos) break;
    rest.remove_prefix(at + length);
    if (trimmed(rest).empty()) break;
  }
  size_t bare = 0;  // parts that are adjectives alone, at the begin
  while (bare < parts.size() && is_adjective_alone(parts[bare], vocabulary)) ++bare;
  if (bare == 0 || bare == parts.size()) return whole;
  std::string& last = parts[bare];
  const auto place = find_relation(last);
  const std::string target(trimmed(std::string_view(last).substr(0, place ? place->at : last.size())));
  const std::string where = place ? " " + last.substr(place->at) : "";
  const std::string noun(noun_of(target, vocabulary));
  const auto label = vocabulary.find(noun);
  if (!label || noun == target) return whole;
  const std::string one =
      vocabulary.is_plural(noun) ? vocabulary.labels().classes.at(static_cast<size_t>(*label)).name : std::string(noun);
  std::string out;
  for (size_t i = 0; i < bare; ++i) out += parts[i] + " " + one + where + " and ";
  out += target.substr(0, target.size() - noun.size()) + one + where;
  for (size_t i = bare + 1; i < parts.size(); ++i) out += " and " + parts[i];
  return out;
}

}  // namespace aligngs
