#include "edit/selection_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr size_t kLongestText = 4096;    // bytes: hundreds of names
constexpr int kLargestInstance = 65535;  // ushort in scene.labels.ply
constexpr const char* kExample = "for example \"pillow, cushion#2\" or \"everything but wall, floor\"";

std::string_view trimmed(std::string_view text) {
  const char* blanks = " \t\r\n";
  const size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Place of `word` by itself in `text` (any case), from `from` on; npos when nowhere.
size_t find_word(std::string_view text, std::string_view word, size_t from = 0) {
  const std::string lower = [&] {
    std::string s(text);
    for (char& c : s) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return s;
  }();
  for (size_t at = lower.find(word, from); at != std::string::npos; at = lower.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at == 0 || is_blank(lower[at - 1]) || lower[at - 1] == ',') &&
        (end == lower.size() || is_blank(lower[end]) || lower[end] == ',')) {
      return at;
    }
  }
  return std::string::npos;
}

int parse_instance(std::string_view text, std::string_view item) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size() || n < 1 || n > kLargestInstance) {
    throw_usage("\"" + std::string(item) + "\" has no object number after '#'",
                "objects are numbered from 1: \"pillow#2\"");
  }
  return n;
}

SelectionTerm parse_term(std::string_view item, const Vocabulary& vocabulary) {
  SelectionTerm term;
  const size_t hash = item.rfind('#');
  if (hash != std::string_view::npos) term.instance = parse_instance(trimmed(item.substr(hash + 1)), item);
  term.label = vocabulary.resolve(trimmed(item.substr(0, hash)));
  return term;
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
    if (item.empty()) throw_usage("a selection has an empty item", kExample);
    const size_t conjunction = vocabulary.find(item) ? std::string_view::npos : find_word(item, "and", 1);
    const std::string_view first = trimmed(item.substr(0, conjunction));
    if (everything && is_everything(first) && !vocabulary.find(first)) {
      *everything = true;
    } else {
      terms.push_back(parse_term(first, vocabulary));
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
  const std::string& name = labels.classes.at(term.label).name;
  return term.instance ? name + "#" + std::to_string(term.instance) : name;
}

void sort_terms(std::vector<SelectionTerm>& terms) {
  const auto key = [](const SelectionTerm& t) { return std::pair(t.label, t.instance); };
  std::sort(terms.begin(), terms.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  terms.erase(std::unique(terms.begin(), terms.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
              terms.end());
}

}  // namespace

SelectionQuery parse_selection(std::string_view text, const Vocabulary& vocabulary) {
  if (text.size() > kLongestText) throw_usage("the selection is longer than 4096 bytes", kExample);
  if (text.find('\0') != std::string_view::npos) throw_usage("the selection holds a zero byte", kExample);
  text = trimmed(text);
  if (text.empty()) throw_usage("nothing is selected", kExample);
  size_t exception = std::string_view::npos, exception_end = 0;
  for (const std::string_view word : {"but", "except", "without"}) {
    const size_t at = find_word(text, word);
    if (at < exception) {
      exception = at;
      exception_end = at + word.size();
    }
  }
  SelectionQuery query;
  parse_list(text.substr(0, exception), vocabulary, query.include, &query.everything);
  if (exception != std::string_view::npos) parse_list(text.substr(exception_end), vocabulary, query.exclude, nullptr);
  sort_terms(query.include);
  sort_terms(query.exclude);
  if (query.everything) query.include.clear();
  return query;
}

std::string selection_text(const SelectionQuery& query, const LabelSet& labels) {
  std::string text = query.everything ? "everything" : "";
  for (const SelectionTerm& term : query.include) text += (text.empty() ? "" : ", ") + term_text(term, labels);
  for (size_t i = 0; i < query.exclude.size(); ++i) text += (i ? ", " : " but ") + term_text(query.exclude[i], labels);
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
