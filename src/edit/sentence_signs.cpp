#include "edit/sentence_signs.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include "core/letter_case.h"
#include "edit/edit_text.h"
#include "edit/selection_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

/// Longer ones before those that they begin with.
constexpr std::string_view kNegations[] = {"do not",   "don't",      "don\xe2\x80\x99t", "dont",   "never",
                                           "must not", "should not", "can not",          "cannot", "not"};

bool is_edit_verb(const std::string& word) {
  constexpr std::string_view kEndingVerbs[] = {"leave", "spare", "undo"};
  const std::vector<std::string> verbs = edit_verbs();
  return std::find(verbs.begin(), verbs.end(), word) != verbs.end() ||
         std::find(std::begin(kEndingVerbs), std::end(kEndingVerbs), word) != std::end(kEndingVerbs);
}

std::vector<std::string> sentence_words(std::string_view text) {
  std::vector<std::string> words;
  for (text = trimmed(text); !text.empty();) {
    const size_t end = std::min(text.find_first_of(" \t\r\n"), text.size());
    words.push_back(lower_case(text.substr(0, end)));
    text = trimmed(text.substr(end));
  }
  return words;
}

}  // namespace

bool has_negation(const std::string& text) {
  return std::any_of(std::begin(kNegations), std::end(kNegations),
                     [&](std::string_view word) { return find_word(text, word) != std::string::npos; });
}

std::string behind_negation(const std::string& text) {
  std::string_view rest = trimmed(text);
  for (const std::string_view word : kNegations) {
    if (take_phrase(rest, word)) break;
  }
  return std::string(rest);
}

std::optional<std::string> second_verb(const std::string& text) {
  const std::vector<std::string> words = sentence_words(text);
  for (size_t i = 1; i < words.size(); ++i) {
    const std::string& before = words[i - 1];
    const bool begins = before == "and" || before == "then" || before == "but" || before.back() == ',';
    const bool is_turn = i + 1 < words.size() && words[i + 1] == "by";
    if (begins && !is_turn && is_edit_verb(words[i])) return words[i];
  }
  return std::nullopt;
}

}  // namespace aligngs
