// The words of an enum in one table, from which reading, writing, help and the manual follow.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

template <class Choice>
struct ChoiceWord {
  Choice choice;
  std::string_view word;
};

/// Specialised for each enum whose values people write: a std::array of ChoiceWord, in the order of help. Every value
/// has one word, and every word one value.
template <class Choice>
inline constexpr std::array<ChoiceWord<Choice>, 0> kChoiceWords{};

/// "metric"; empty for what is no value of the enum.
template <class Choice>
constexpr std::string_view word_of(Choice choice) {
  for (const ChoiceWord<Choice>& row : kChoiceWords<Choice>) {
    if (row.choice == choice) return row.word;
  }
  return {};
}

/// Empty for a word that the table does not have.
template <class Choice>
constexpr std::optional<Choice> choice_named(std::string_view word) {
  for (const ChoiceWord<Choice>& row : kChoiceWords<Choice>) {
    if (row.word == word) return row.choice;
  }
  return std::nullopt;
}

/// "auto|metric|relative|none" with "|" between the words, "preview, default or paper" with ", " and " or ".
template <class Choice>
std::string joined_words(std::string_view between, std::string_view before_last) {
  std::string text;
  const size_t count = kChoiceWords<Choice>.size();
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) text += i + 1 == count ? before_last : between;
    text += kChoiceWords<Choice>[i].word;
  }
  return text;
}

/// For the options of a command line.
template <class Choice>
std::vector<std::string> choice_list() {
  std::vector<std::string> words;
  for (const ChoiceWord<Choice>& row : kChoiceWords<Choice>) words.emplace_back(row.word);
  return words;
}

}  // namespace aligngs
