#include "edit/selection_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <tuple>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/item_adjectives.h"
#include "edit/plain_words.h"
#include "edit/selection_item.h"
#include "edit/shared_place.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr size_t kLongestText = 4096;  // bytes: hundreds of names
constexpr const char* kSelectionExample = "for example \"pillow, cushion#2\" or \"everything but wall, floor\"";

bool is_everything(std::string_view item) {
  const std::string word = folded_name(item);
  return word == "everything" || word == "all";
}

/// "The pillows on the bed and the sofa" may mean the sofa, or the pillows on it.
[[noreturn]] void refuse_two_readings(const RelatedItem& before, std::string_view after) {
  const std::string target(before.target), place(before.place), other(after);
  const auto found = find_relation(before.place, true);
  const std::string relation(before.place.substr(0, found->length));
  throw_usage("\"" + target + " " + place + " and " + other + "\" has two readings",
              "did you mean \"" + target + " " + place + ", " + other + "\" or \"" + target + " " + place + ", " +
                  target + " " + relation + " " + other + "\"?");
}

/// Names have no double quotes, so that those around a name say nothing.
std::string without_double_quotes(std::string_view given) {
  std::string text(given);
  for (const std::string_view quote : {"\"", "\xe2\x80\x9c", "\xe2\x80\x9d"}) {
    for (size_t at = text.find(quote); at != std::string::npos; at = text.find(quote, at)) text.erase(at, quote.size());
  }
  return text;
}

/// "'bed'" is bed: shells of other systems leave quotes in. Double ones are gone already.
std::string_view without_quotes(std::string_view item) {
  item = trimmed(item);
  const bool quoted = item.size() > 2 && item.front() == '\'' && item.back() == '\'';
  return quoted ? trimmed(item.substr(1, item.size() - 2)) : item;
}

/// "The armchair and the cushion on it" with the name in place of "it".
std::string with_previous_name(std::string whole, const std::string& previous, const Vocabulary& vocabulary) {
  for (const std::string_view word : {"it", "them"}) {
    const size_t at = find_word(whole, word, 1);
    if (at == std::string::npos || at + word.size() != whole.size() || previous.empty()) continue;
    if (related_item(previous, vocabulary))
      throw_usage("\"" + std::string(word) + "\" may mean two things in \"" + previous + "\"",
                  "name the one that is meant");
    whole.replace(at, word.size(), previous);
  }
  return whole;
}

/// One item in the words of the grammar; a conjunction after a comma stays before it.
std::string spelled_plainly(std::string_view item, const Vocabulary& vocabulary) {
  item = vocabulary.find_selection(item) ? trimmed(item) : without_quotes(item);
  if (vocabulary.find(item) || vocabulary.find_selection(item)) return std::string(item);
  const std::string named = with_each_name(item, vocabulary);
  std::string out;
  for (std::string_view rest = named;;) {
    const auto [at, length] = find_conjunction(rest, 0);
    out += in_plain_words(rest.substr(0, at), vocabulary);
    if (at == std::string_view::npos) return out;
    out += (out.empty() ? "" : " ") + std::string(rest.substr(at, length)) + " ";
    rest.remove_prefix(at + length);
  }
}

/// One item between commas; "a and b" is two unless a class is called so. "And" may also follow a comma.
void parse_item(std::string_view item, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms,
                bool* everything, std::string& previous) {
  std::optional<RelatedItem> before;  // of an item that tells a place, and has a conjunction after it
  std::vector<BareName> bare;         // names before it that tell none
  while (true) {
    item = vocabulary.find_selection(item) ? trimmed(item) : without_quotes(item);
    if (item.empty()) throw_usage("a selection has an empty item", kSelectionExample);
    if (const auto [at, length] = find_conjunction(item); at == 0 && !terms.empty() && !vocabulary.find(item)) {
      item = trimmed(item.substr(length));
      if (item.empty()) throw_usage("a selection has an empty item", kSelectionExample);
    }
    auto [conjunction, length] =
        vocabulary.find(item) ? std::pair(std::string_view::npos, size_t(0)) : find_conjunction(item, 1);
    const bool has_two_sides = conjunction != std::string_view::npos && wants_other_side(item.substr(0, conjunction));
    if (has_two_sides) std::tie(conjunction, length) = find_conjunction(item, conjunction + length);
    const std::string_view first = trimmed(item.substr(0, conjunction));
    std::string whole(first);
    if (before && find_relation(first, true)) whole = std::string(before->target) + " " + whole;  // "and on the sofa"
    const auto related = related_item(whole == first ? first : std::string_view(whole), vocabulary);
    if (before && !related) refuse_two_readings(*before, first);
    whole = with_previous_name(whole, previous, vocabulary);
    const size_t begin = terms.size();
    if (everything && is_everything(first) && !vocabulary.find(first)) {
      *everything = true;
    } else {
      parse_item_terms(whole, vocabulary, terms);
    }
    if (related && whole == first) require_own_place(bare, *related, terms, begin, vocabulary.labels());
    if (related) {
      bare.clear();
    } else if (terms.size() > begin) {
      bare.push_back({whole, begin});
    }
    previous = whole;
    if (has_two_sides) {
      before.reset();  // "and" after both sides begins another item
    } else if (related && whole == first) {
      before = related;
    }
    if (conjunction == std::string_view::npos) return;
    item.remove_prefix(conjunction + length);
  }
}

void parse_list(std::string_view text, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms,
                bool* everything) {
  std::string previous;  // what "it" means
  while (true) {
    const size_t comma = text.find_first_of(",;");
    const std::string item = spelled_plainly(text.substr(0, comma), vocabulary);
    parse_item(item, vocabulary, terms, everything, previous);
    if (comma == std::string_view::npos || trimmed(text.substr(comma + 1)).empty()) return;  // "bed, lamp,"
    text.remove_prefix(comma + 1);
  }
}

/// "Every lamp but the left one" with the name of what stays. One class is included then, and the words are no names.
std::string spelled_out(std::string_view excluded, const SelectionQuery& query, const Vocabulary& vocabulary) {
  const bool one_class = !query.everything && !query.include.empty() && query.include.front().label >= 0 &&
                         query.include.front().label == query.include.back().label;
  if (!one_class || vocabulary.find(excluded)) return std::string(excluded);
  const LabelSet& labels = vocabulary.labels();
  return with_name(excluded, labels.classes.at(static_cast<size_t>(query.include.front().label)).name);
}

/// "largest", "2 largest" or "2nd largest".
std::string choice_text(const SelectionTerm& term) {
  const std::string word = choice_word(term.choice);
  if (term.count > 1) return std::to_string(term.count) + " " + word;
  return term.rank > 1 ? ordinal_text(term.rank) + " " + word : word;
}

std::string place_text(const RelatedTo& place, const LabelSet& labels);

std::string term_text(const SelectionTerm& term, const LabelSet& labels) {
  if (!term.named.empty()) return term.named;
  const std::string name = (term.color.empty() ? "" : term.color + " ") +
                           (term.label < 0 ? std::string(group_name(term.group)) : labels.classes.at(term.label).name);
  std::string text = term.choice != ObjectChoice::kNone ? choice_text(term) + " " + name
                     : term.instance                    ? name + "#" + std::to_string(term.instance)
                     : term.count > 1                   ? std::to_string(term.count) + " x " + name
                     : term.relation && term.count == 0 ? "all " + name
                                                        : name;
  return term.relation ? text + place_text(*term.relation, labels) : text;
}

std::string place_text(const RelatedTo& place, const LabelSet& labels) {
  std::string text = place.also ? place_text(*place.also, labels) : "";
  text += (place.negated ? " not " : " ") + std::string(relation_word(place.relation));
  if (is_of_room(place.relation)) return text;
  text += " ";
  for (const SelectionTerm& anchor : place.anchors)
    text += (&anchor == place.anchors.data() ? "" : ", ") + term_text(anchor, labels);
  for (const SelectionTerm& other : place.other_side)
    text += (&other == place.other_side.data() ? " and " : ", ") + term_text(other, labels);
  return text;
}

/// Terms with commas between; three or more numbers in a row are a range.
std::string terms_text(const std::vector<SelectionTerm>& terms, const LabelSet& labels) {
  constexpr size_t kShortestRange = 3;
  std::string text;
  for (size_t i = 0; i < terms.size();) {
    size_t end = i + 1;
    while (end < terms.size() && terms[i].instance > 0 && terms[end].label == terms[i].label &&
           terms[end].instance == terms[end - 1].instance + 1 && !terms[i].relation && !terms[end].relation) {
      ++end;
    }
    if (end - i < kShortestRange) end = i + 1;
    text += (text.empty() ? "" : ", ") + term_text(terms[i], labels);
    if (end > i + 1) text += "-" + std::to_string(terms[end - 1].instance);
    i = end;
  }
  return text;
}

}  // namespace

void sort_terms(std::vector<SelectionTerm>& terms) {
  const auto key = [](const SelectionTerm& t) {
    return std::tie(t.label, t.instance, t.choice, t.rank, t.named, t.group, t.count, t.relation, t.color, t.among,
                    t.narrow);
  };
  std::sort(terms.begin(), terms.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  terms.erase(std::unique(terms.begin(), terms.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
              terms.end());
}

SelectionQuery parse_selection(std::string_view given, const Vocabulary& vocabulary) {
  if (given.size() > kLongestText) throw_usage("the selection is longer than 4096 bytes", kSelectionExample);
  if (given.find('\0') != std::string_view::npos) throw_usage("the selection holds a zero byte", kSelectionExample);
  const std::string unquoted = without_double_quotes(given);
  const std::string_view text = trimmed(unquoted);
  if (text.empty()) throw_usage("nothing is selected", kSelectionExample);
  const auto [exception, length] = find_exception(text);
  std::string_view included = trimmed(text.substr(0, exception));
  const bool excludes = exception != std::string_view::npos;
  if (excludes && !included.empty() && included.back() == ',') included.remove_suffix(1);  // "all lamps, except lamp#2"
  SelectionQuery query;
  parse_list(included, vocabulary, query.include, &query.everything);
  if (excludes) {
    const std::string_view excluded = trimmed(text.substr(exception + length));
    parse_list(spelled_out(excluded, query, vocabulary), vocabulary, query.exclude, nullptr);
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
