#include "edit/selection_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <tuple>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr size_t kLongestText = 4096;  // bytes: hundreds of names
constexpr int kMostNumbers = 1000;     // objects of one range
constexpr const char* kSelectionExample = "for example \"pillow, cushion#2\" or \"everything but wall, floor\"";

/// "pillow 2" for "pillow#2": the number, where the words before it are a name.
std::string_view take_spoken_number(std::string_view& item, const Vocabulary& vocabulary) {
  const size_t blank = item.find_last_of(" \t");
  if (blank == std::string_view::npos || object_numbers(item.substr(blank)).first == 0) return {};
  const std::string_view name = trimmed(item.substr(0, blank));
  if (!vocabulary.find(name)) return {};
  const std::string_view number = trimmed(item.substr(blank));
  item = name;
  return number;
}

/// Adds the terms of one item.
void parse_term(std::string_view item, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms) {
  SelectionTerm term;
  const std::string whole(item);
  if (const auto named = vocabulary.find_selection(item)) {
    term.label = -1;
    term.named = *named;
    terms.push_back(term);
    return;
  }
  if (!vocabulary.find(item)) item = without_quantifier(item);
  if (!vocabulary.find(item)) term.choice = take_choice(item);
  const size_t hash = item.find('#');
  std::string_view numbers;
  if (hash != std::string_view::npos) {
    numbers = trimmed(item.substr(hash + 1));
    item = trimmed(item.substr(0, hash));
  } else if (!vocabulary.find(item)) {
    numbers = take_spoken_number(item, vocabulary);
  }
  if (item.empty() && !terms.empty() && terms.back().named.empty()) {
    term.label = terms.back().label;
  } else {
    term.label = vocabulary.resolve(item);
  }
  if (hash == std::string_view::npos && numbers.empty()) {
    terms.push_back(term);
    return;
  }
  const auto [first, last] = object_numbers(numbers);
  if (first == 0 || last - first >= kMostNumbers || term.choice != ObjectChoice::kNone) {
    throw_usage("\"" + whole + "\" has no object number after '#'",
                "objects are numbered from 1: \"pillow#2\" or \"pillow#1-3\"");
  }
  for (term.instance = first; term.instance <= last; ++term.instance) terms.push_back(term);
}

bool is_everything(std::string_view item) {
  const std::string word = folded_name(item);
  return word == "everything" || word == "all";
}

/// One item between commas; "a and b" is two unless a class is called so.
void parse_item(std::string_view item, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms,
                bool* everything) {
  while (true) {
    item = trimmed(item);
    if (item.empty()) throw_usage("a selection has an empty item", kSelectionExample);
    const size_t conjunction = vocabulary.find(item) ? std::string_view::npos : find_word(item, "and", 1);
    const std::string_view first = trimmed(item.substr(0, conjunction));
    if (everything && is_everything(first) && !vocabulary.find(first)) {
      *everything = true;
    } else {
      parse_term(first, vocabulary, terms);
    }
    if (conjunction == std::string_view::npos) return;
    item.remove_prefix(conjunction + 3);
  }
}

void parse_list(std::string_view text, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms,
                bool* everything) {
  while (true) {
    const size_t comma = text.find(',');
    parse_item(text.substr(0, comma), vocabulary, terms, everything);
    if (comma == std::string_view::npos) return;
    text.remove_prefix(comma + 1);
  }
}

std::string term_text(const SelectionTerm& term, const LabelSet& labels) {
  if (!term.named.empty()) return term.named;
  const std::string& name = labels.classes.at(term.label).name;
  if (term.choice != ObjectChoice::kNone) return choice_word(term.choice) + " " + name;
  return term.instance ? name + "#" + std::to_string(term.instance) : name;
}

/// Terms with commas between; three or more numbers in a row are a range.
std::string terms_text(const std::vector<SelectionTerm>& terms, const LabelSet& labels) {
  constexpr size_t kShortestRange = 3;
  std::string text;
  for (size_t i = 0; i < terms.size();) {
    size_t end = i + 1;
    while (end < terms.size() && terms[i].instance > 0 && terms[end].label == terms[i].label &&
           terms[end].instance == terms[end - 1].instance + 1) {
      ++end;
    }
    if (end - i < kShortestRange) end = i + 1;
    text += (text.empty() ? "" : ", ") + term_text(terms[i], labels);
    if (end > i + 1) text += "-" + std::to_string(terms[end - 1].instance);
    i = end;
  }
  return text;
}

void sort_terms(std::vector<SelectionTerm>& terms) {
  const auto key = [](const SelectionTerm& t) { return std::tie(t.label, t.instance, t.choice, t.named); };
  std::sort(terms.begin(), terms.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  terms.erase(std::unique(terms.begin(), terms.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
              terms.end());
}

}  // namespace

SelectionQuery parse_selection(std::string_view text, const Vocabulary& vocabulary) {
  if (text.size() > kLongestText) throw_usage("the selection is longer than 4096 bytes", kSelectionExample);
  if (text.find('\0') != std::string_view::npos) throw_usage("the selection holds a zero byte", kSelectionExample);
  text = trimmed(text);
  if (text.empty()) throw_usage("nothing is selected", kSelectionExample);
  size_t exception = std::string_view::npos, exception_end = 0;
  for (const std::string_view word : {"but", "except", "without", "excluding"}) {
    const size_t at = find_word(text, word);
    if (at < exception) {
      exception = at;
      exception_end = at + word.size();
    }
  }
  SelectionQuery query;
  parse_list(text.substr(0, exception), vocabulary, query.include, &query.everything);
  if (exception != std::string_view::npos) {
    std::string_view rest = trimmed(text.substr(exception_end));
    if (find_word(rest, "not") == 0) rest.remove_prefix(3);  // "every lamp but not lamp#2"
    parse_list(rest, vocabulary, query.exclude, nullptr);
  }
  sort_terms(query.include);
  sort_terms(query.exclude);
  if (query.everything) query.include.clear();
  return query;
}

std::string selection_text(const SelectionQuery& query, const LabelSet& labels) {
  std::string text = query.everything ? "everything" : "";
  if (!query.include.empty()) text += (text.empty() ? "" : ", ") + terms_text(query.include, labels);
  if (!query.exclude.empty()) text += " but " + terms_text(query.exclude, labels);
  return text;
}

ThresholdRule parse_threshold(std::string_view text) {
  std::string word(trimmed(text));
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (word == "argmax") return {ThresholdRule::Kind::kArgmax, 0};
  if (word == "auto") return {ThresholdRule::Kind::kAuto, 0};
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value > 0 && value <= 1)) {
    throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no threshold",
                "give argmax, auto or a probability above 0 and up to 1");
  }
  return {ThresholdRule::Kind::kValue, value};
}

std::string threshold_text(const ThresholdRule& rule) {
  if (rule.kind == ThresholdRule::Kind::kArgmax) return "argmax";
  return rule.kind == ThresholdRule::Kind::kAuto ? "auto" : fmt::format("{:.9g}", rule.value);
}

}  // namespace aligngs
