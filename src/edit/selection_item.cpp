#include "edit/selection_item.h"

#include <utility>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/item_adjectives.h"
#include "edit/refused_items.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr int kDeepest = 3;  // "the lamp on the table near the window" has two

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
  if (terms.empty() || terms.back().label < 0 || terms.back().relation) return false;
  return name.empty() || (numbers.empty() && terms.back().instance > 0 && object_numbers(name).first > 0);
}

/// Adds the terms of an item. Its place is read elsewhere.
void parse_plain(std::string_view item, const Vocabulary& vocabulary, bool has_place,
                 std::vector<SelectionTerm>& terms) {
  SelectionTerm term;
  const std::string_view whole = item;
  if (!vocabulary.find(item)) refuse_each_nth(item);
  const bool is_a = means_any_one(item, vocabulary);
  take_adjectives(item, vocabulary, term);
  if (!vocabulary.find(item)) {
    if (const auto group = find_group(item); group && (has_place || !group->needs_place)) {
      term.label = -1;
      term.group = group->group;
      if (is_a) term.count = 0;
      if (group->one && term.choice == ObjectChoice::kNone) term.count = 1;
      terms.push_back(term);
      return;
    }
  }
  term.narrow = narrow_place(item);
  const int ordinal = vocabulary.find(item) || term.choice != ObjectChoice::kNone ? 0 : take_ordinal(item);
  if (ordinal > 0) {
    term.count = 0;
    term.label = vocabulary.resolve(item);
    term.instance = ordinal;
    terms.push_back(term);
    return;
  }
  const size_t hash = item.find('#');
  std::string_view numbers;
  if (hash != std::string_view::npos) {
    numbers = trimmed(item.substr(hash + 1));
    item = trimmed(item.substr(0, hash));
  } else if (!vocabulary.find(item)) {
    numbers = take_spoken_number(item, vocabulary);
  }
  if (item.empty() && !continues(terms, item, numbers))
    throw_usage("\"" + std::string(whole) + "\" has no name", "objects have one before their number: \"pillow#2\"");
  if (!vocabulary.find(item) && continues(terms, item, numbers)) {
    term.label = terms.back().label;
    if (!item.empty()) numbers = item;
  } else {
    constexpr std::string_view kOther = "other ";
    const std::string name = without_article(folded_name(item));
    if (name.starts_with(kOther) && vocabulary.find(name.substr(kOther.size())))
      refuse_other(name.substr(kOther.size()));
    if (!vocabulary.find(item)) refuse_one(whole, item);
    term.label = vocabulary.resolve(item);
  }
  if (hash == std::string_view::npos && numbers.empty()) {
    terms.push_back(term);
    return;
  }
  if (is_a) term.count = 0;
  const auto [first, last] = object_numbers(numbers);
  if (first == 0 || last - first >= kMostNumbersOfRange || term.choice != ObjectChoice::kNone)
    refuse_numbers(whole, numbers);
  for (term.instance = first; term.instance <= last; ++term.instance) terms.push_back(term);
}

bool is_article(std::string_view words) { return lower_case(trimmed(words)) == "the"; }

void parse_related(std::string_view item, const Vocabulary& vocabulary, int depth, std::vector<SelectionTerm>& terms);

/// Reads the things that another one is on or near, and returns whether any of them will do: "the beds".
bool parse_anchor(std::string_view anchor, Relation relation, const Vocabulary& vocabulary, int depth,
                  std::vector<SelectionTerm>& anchors) {
  bool any = false;
  if (!vocabulary.find(anchor) && !vocabulary.find_selection(anchor)) refuse_viewer(anchor);
  parse_related(anchor, vocabulary, depth + 1, anchors);
  for (SelectionTerm& term : anchors) {
    if (!term.named.empty())
      throw_usage("a selection by hand has no place that others are " + std::string(relation_word(relation)),
                  "name an object by its class");
    any |= term.group != ClassGroup::kNone || term.count > 1;
    if (!term.relation && term.count == 1) term.count = 0;  // any bed that a pillow is on
  }
  const auto inner = related_item(anchor, vocabulary);
  const std::string_view name = inner ? inner->target : anchor;
  return any || begins_with_quantifier(name) || vocabulary.is_plural(name) || anchors.size() > 1;
}

/// "On the wall above the bed" in its two places. A wall is one object, so that both are places of the thing on it.
struct PlaceOnShell {
  std::string on;            ///< "on the wall"
  std::string_view further;  ///< "above the bed"
  bool negated = false;      ///< "not above the bed"
};

std::optional<PlaceOnShell> parted_at_shell(std::string_view place, const FoundRelation& found,
                                            const Vocabulary& vocabulary) {
  const Relation relation = found.relation;
  if (relation != Relation::kOn && relation != Relation::kNextTo && relation != Relation::kNear) return std::nullopt;
  const auto inner = related_item(place.substr(found.length), vocabulary);
  if (!inner || inner->side != ObjectChoice::kNone || !inner->row.empty()) return std::nullopt;
  const auto label = vocabulary.find(noun_of(inner->target, vocabulary));
  if (!label || is_of_group(vocabulary.labels(), *label, ClassGroup::kThings)) return std::nullopt;
  const auto further = find_relation(inner->place, true);
  if (!further || further->relation == Relation::kHolding || further->relation == Relation::kOwned)
    return std::nullopt;  // "near the wall with the painting on it"
  const std::string on = std::string(place.substr(0, found.length)) + " " + std::string(inner->target);
  return PlaceOnShell{on, inner->place, inner->negated};
}

/// The place of a term, from its words: "on the largest bed".
std::shared_ptr<const RelatedTo> place_of(std::string_view place, bool negated, const Vocabulary& vocabulary,
                                          int depth) {
  const auto found = find_relation(place, true);
  if (const auto parted = parted_at_shell(place, *found, vocabulary)) {
    const std::string further(parted->further);
    if (negated)
      throw_usage("\"not " + std::string(place) + "\" has two readings",
                  "did you mean \"not " + parted->on + "\" or \"not " + further + "\"?");
    RelatedTo both = *place_of(further, parted->negated, vocabulary, depth);
    if (both.also) throw_usage("\"" + std::string(place) + "\" tells too many places", "say it in fewer words");
    both.also = place_of(parted->on, false, vocabulary, depth);
    return std::make_shared<const RelatedTo>(std::move(both));
  }
  RelatedTo related;
  related.negated = negated;
  related.relation = found->relation;
  std::string_view anchor = trimmed(place.substr(found->length)), other;
  if (related.relation == Relation::kBetween && !vocabulary.find(anchor)) {
    if (const auto [at, length] = find_conjunction(anchor, 1); at != std::string_view::npos) {
      other = trimmed(anchor.substr(at + length));
      anchor = trimmed(anchor.substr(0, at));
    }
  }
  if (is_of_room(related.relation)) {
    if (!anchor.empty())
      throw_usage("\"" + std::string(place) + "\" is no place", "say \"in the corner\", for example");
    return std::make_shared<const RelatedTo>(std::move(related));
  }
  related.any_anchor = parse_anchor(anchor, related.relation, vocabulary, depth, related.anchors);
  if (related.relation != Relation::kBetween) return std::make_shared<const RelatedTo>(std::move(related));
  if (!other.empty()) {
    parse_anchor(other, related.relation, vocabulary, depth, related.other_side);
  } else if (!related.any_anchor) {
    throw_usage("\"between " + std::string(anchor) + "\" names one thing",
                "say two, such as \"between the bed and the window\" or \"between the beds\"");
  }
  related.any_anchor = true;
  return std::make_shared<const RelatedTo>(std::move(related));
}

void parse_related(std::string_view item, const Vocabulary& vocabulary, int depth, std::vector<SelectionTerm>& terms) {
  const auto related = related_item(item, vocabulary);
  if (!related) return parse_plain(item, vocabulary, false, terms);
  if (depth >= kDeepest) throw_usage("a selection tells more than three places", "say it in fewer words");
  const size_t first = terms.size();
  const std::string target = std::string(related->target) + std::string(related->row);
  parse_plain(target, vocabulary, true, terms);
  const auto place = place_of(related->place, related->negated, vocabulary, depth);
  const std::string_view noun = noun_of(related->target, vocabulary);
  const bool is_any = begins_with_quantifier(related->target) || vocabulary.is_plural(noun);
  const bool is_many = is_any || terms[first].group != ClassGroup::kNone;
  if (related->side != ObjectChoice::kNone && is_many && terms[first].count == 0)
    throw_usage("\"" + std::string(trimmed(item)) + "\" does not tell how many are meant",
                "say \"the two\" before it, or which place is on that side, such as \"the pillows on the left bed\"");
  for (size_t i = first; i < terms.size(); ++i) {
    SelectionTerm& term = terms[i];
    term.relation = place;
    if (term.choice == ObjectChoice::kNone) term.choice = related->side;
    if (is_any || term.group != ClassGroup::kNone || term.choice != ObjectChoice::kNone) continue;
    if (term.instance == 0 && term.count == 0) term.count = 1;
  }
  std::string_view counted = related->target;
  SelectionTerm& term = terms[first];
  if (terms.size() != first + 1 || term.instance == 0 || take_ordinal(counted) == 0) return;
  if (!is_in_order(place->relation)) {
    throw_usage("\"" + std::string(related->target) + "\" counts the objects of the whole room",
                "leave out the place, or say which by size or side, such as \"the largest\"");
  }
  term.rank = term.instance;  // "the second chair nearest to the window"
  term.instance = 0;
  term.count = 1;
}

}  // namespace

std::optional<RelatedItem> related_item(std::string_view item, const Vocabulary& vocabulary) {
  item = trimmed(item);
  if (vocabulary.find(item) || vocabulary.find_selection(item)) return std::nullopt;
  RelatedItem related;
  related.side = take_place(item);
  if (counts_from_side(item)) {
    const size_t row = lower_case(item).rfind(" from ");
    related.row = item.substr(row);
    item = item.substr(0, row);
  }
  auto found = find_relation(item);
  if (found && is_article(item.substr(0, found->at))) {  // "the left of the lamps on the shelf"
    const size_t after = found->at + found->length;
    found = find_relation(item.substr(after));
    if (found) found->at += after;
  }
  if (!found) return std::nullopt;
  related.target = without_filler(item.substr(0, found->at));
  related.place = trimmed(item.substr(found->at));
  std::string_view end = related.target;
  constexpr std::string_view kNot = " not";
  if (lower_case(end).ends_with(kNot)) {
    related.negated = true;
    related.target = without_filler(end.substr(0, end.size() - kNot.size()));
  }
  return related;
}

void parse_item_terms(std::string_view item, const Vocabulary& vocabulary, std::vector<SelectionTerm>& terms) {
  if (const auto named = vocabulary.find_selection(item)) {
    SelectionTerm term;
    term.label = -1;
    term.named = *named;
    terms.push_back(term);
    return;
  }
  parse_related(item, vocabulary, 0, terms);
}

}  // namespace aligngs
