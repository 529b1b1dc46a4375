#include "edit/undo_words.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/selection_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr std::string_view kUndoVerbs[] = {"undo", "revert", "take back"};
constexpr std::string_view kOneBack[] = {"go back", "step back",      "go back one step", "one step back",
                                         "back",    "take that back", "take it back"};
/// Words for taking something back, of which nobody knows how much.
constexpr std::string_view kVague[] = {
    "redo",    "reset",         "start over",          "start again", "restore",
    "cancel",  "put back",      "put it back",         "bring back",  "bring it back",
    "restart", "put them back", "put everything back", "do over"};
constexpr std::string_view kNoMeaning[] = {"the", "edit", "edits", "change", "changes", "number",
                                           "no.", "that", "it",    "my",     "of",      "steps"};
constexpr std::string_view kPlurals[] = {"edits", "changes", "steps", "times"};
constexpr std::string_view kLatest[] = {"last", "latest", "previous"};

template <class Words>
bool is_one_of_words(const Words& words, std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> words;
  for (text = trimmed(text); !text.empty();) {
    const size_t end = std::min(text.find_first_of(" \t\r\n"), text.size());
    words.emplace_back(text.substr(0, end));
    text = trimmed(text.substr(end));
  }
  return words;
}

/// 2 of "2", "#2" and "two"; 0 of other words.
size_t one_number(const std::string& word) {
  const auto [first, last] = object_numbers(word);
  return first == last ? static_cast<size_t>(first) : 0;
}

std::optional<UndoRequest> read_words(const std::vector<std::string>& words) {
  bool many = false, latest = false;
  std::vector<std::string> rest;
  for (const std::string& word : words) {
    many |= is_one_of_words(kPlurals, word);
    latest |= is_one_of_words(kLatest, word);
    if (!is_one_of_words(kNoMeaning, word) && !is_one_of_words(kLatest, word) && word != "times") rest.push_back(word);
  }
  if (rest.empty()) return many ? std::nullopt : std::optional(UndoRequest{});
  if (rest.size() > 1) return std::nullopt;
  const std::string& word = rest.front();
  if (word == "everything" || (word == "all" && !latest)) return UndoRequest{0, UndoRequest::kAll};
  if (word == "twice") return UndoRequest{0, 2};
  const int ordinal = ordinal_number(word);
  if (ordinal > 0 && !many && !latest) return UndoRequest{static_cast<size_t>(ordinal), 1};
  const size_t number = one_number(word);
  if (number == 0) return std::nullopt;
  return many || latest ? UndoRequest{0, number} : UndoRequest{number, 1};
}

}  // namespace

std::optional<UndoRequest> parse_undo(std::string_view given) {
  const std::string text = lower_case(trimmed(given));
  for (const std::string_view verb : kUndoVerbs) {
    if (text.compare(0, verb.size(), verb) != 0 || (text.size() > verb.size() && text[verb.size()] != ' ')) continue;
    const auto request = read_words(split(std::string_view(text).substr(verb.size())));
    if (request) return request;
    throw_usage("\"" + text.substr(0, 40) + "\" does not tell which edit to undo",
                "say \"undo\", \"undo the last two edits\", \"undo everything\" or \"undo #2\"; the oldest edit is the "
                "first");
  }
  if (is_one_of_words(kOneBack, text)) return UndoRequest{};
  const bool is_vague = std::any_of(std::begin(kVague), std::end(kVague), [&](std::string_view words) {
    return text == words || text.starts_with(std::string(words) + " ");
  });
  const bool puts_back = text.ends_with(" back") && (text.starts_with("put ") || text.starts_with("bring ") ||
                                                     text.starts_with("get ") || text.starts_with("give "));
  if (is_vague || puts_back) {
    throw_usage("\"" + text.substr(0, 40) + "\" does not tell what is taken back",
                "did you mean \"undo\", \"undo the last two edits\" or \"undo everything\"? What was undone is done "
                "again by its own words");
  }
  return std::nullopt;
}

}  // namespace aligngs
