#include "edit/selection_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <tuple>

#include "core/error.h"
#include "core/letter_case.h"

namespace aligngs {
namespace {

constexpr size_t kLongestText = 4096;  // bytes: hundreds of names
constexpr int kMostNumbers = 1000;     // objects of one range
constexpr const char* kSelectionExample = "for example \"pillow, cushion#2\" or \"everything but wall, floor\"";

/// "pillow 2" and "pillows 1 to 3" for "pillow#2" and "pillow#1-3": the numbers, where the words before them are a name.
std::string_view take_spoken_number(std::string_view& item, const Vocabulary& vocabulary) {
  for (size_t blank = item.find_first_of(" \t"); blank != std::string_view::npos;
       blank = item.find_first_of(" \t", blank + 1)) {
    const std::string_view name = trimmed(item.substr(0, blank)), numbers = trimmed(item.substr(blank));
    if (object_numbers(numbers).first == 0 || !vocabulary.find(name)) continue;
    item = name;
    return numbers;
  }
  return {};
}

/// "2" after "pillows 1", and "#2" after any name, are of that name.
bool continues(const std::vector<SelectionTerm>& terms, std::string_view name, std::string_view numbers) {
  if (terms.empty() || !terms.back().named.empty()) return false;
  return name.empty() || (numbers.empty() && terms.back().instance > 0 && object_numbers(name).first > 0);
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
  const int ordinal = vocabulary.find(item) || term.choice != ObjectChoice::kNone ? 0 : take_ordinal(item);
  const size_t hash = item.find('#');
  std::string_view numbers;
  if (ordinal > 0) {
    term.label = vocabulary.resolve(item);
    term.instance = ordinal;
    terms.push_back(term);
    return;
  }
  if (hash != std::string_view::npos) {
    numbers = trimmed(item.substr(hash + 1));
    item = trimmed(item.substr(0, hash));
  } else if (!vocabulary.find(item)) {
    numbers = take_spoken_number(item, vocabulary);
  }
  if (!vocabulary.find(item) && continues(terms, item, numbers)) {
    term.label = terms.back().label;
    if (!item.empty()) numbers = item;
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

/// One item between commas; "a and b" is two unless a class is called so. "And" may also follow a comma.
void parse_item(std::string_view item, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms,
                bool* everything) {
  while (true) {
    item = trimmed(item);
    if (item.empty()) throw_usage("a selection has an empty item", kSelectionExample);
    if (const auto [at, length] = find_conjunction(item); at == 0 && !terms.empty() && !vocabulary.find(item)) {
      item = trimmed(item.substr(length));
      if (item.empty()) throw_usage("a selection has an empty item", kSelectionExample);
    }
    const auto [conjunction, length] =
        vocabulary.find(item) ? std::pair(std::string_view::npos, size_t(0)) : find_conjunction(item, 1);
    const std::string_view first = trimmed(item.substr(0, conjunction));
    if (everything && is_everything(first) && !vocabulary.find(first)) {
      *everything = true;
    } else {
      parse_term(first, vocabulary, terms);
    }
    if (conjunction == std::string_view::npos) return;
    item.remove_prefix(conjunction + length);
  }
}

void parse_list(std::string_view text, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms,
                bool* everything) {
  while (true) {
    const size_t comma = text.find_first_of(",;");
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
  const auto [exception, length] = find_exception(text);
  std::string_view included = trimmed(text.substr(0, exception));
  const bool excludes = exception != std::string_view::npos;
  if (excludes && !included.empty() && included.back() == ',') included.remove_suffix(1);  // "all lamps, except lamp#2"
  SelectionQuery query;
  parse_list(included, vocabulary, query.include, &query.everything);
  if (excludes) parse_list(trimmed(text.substr(exception + length)), vocabulary, query.exclude, nullptr);
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
  const std::string word = lower_case(trimmed(text));
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
