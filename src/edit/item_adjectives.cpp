#include "edit/item_adjectives.h"

#include <utility>

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/relation/class_groups.h"
#include "edit/relation/color_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr std::pair<std::string_view, ObjectChoice> kSides[] = {
    {" from the left side", ObjectChoice::kLeft}, {" from the right side", ObjectChoice::kRight},
    {" from the left", ObjectChoice::kLeft},      {" from the right", ObjectChoice::kRight},
    {" from left", ObjectChoice::kLeft},          {" from right", ObjectChoice::kRight},
    {" from the top", ObjectChoice::kHighest},    {" from the bottom", ObjectChoice::kLowest},
    {" from above", ObjectChoice::kHighest},      {" from below", ObjectChoice::kLowest}};

ObjectChoice opposite(ObjectChoice side) {
  if (side == ObjectChoice::kLeft) return ObjectChoice::kRight;
  if (side == ObjectChoice::kRight) return ObjectChoice::kLeft;
  return side == ObjectChoice::kHighest ? ObjectChoice::kLowest : ObjectChoice::kHighest;
}

/// Takes "from the left" off the end.
ObjectChoice take_side(std::string_view& item) {
  for (const auto& [ending, side] : kSides) {
    if (item.size() <= ending.size() || !lower_case(item).ends_with(ending)) continue;
    item = trimmed(item.substr(0, item.size() - ending.size()));
    return side;
  }
  return ObjectChoice::kNone;
}

/// Takes "one of the" off the begin.
bool take_one_of(std::string_view& item) {
  for (const std::string_view words : {"one of the", "one of my", "one of these", "one of those", "any one of the",
                                       "either of the", "either one of the", "either"}) {
    if (take_phrase(item, words)) return true;
  }
  return false;
}

/// "Pillows", "things" and "furniture" are several.
bool names_several(std::string_view noun, const Vocabulary& vocabulary) {
  if (vocabulary.find(noun)) return vocabulary.is_plural(noun);
  const auto group = find_group(noun);
  return group && !group->one && !group->needs_place;
}

bool asks_for_all(std::string_view item) {
  for (const std::string_view word : {"all", "every", "each"}) {
    std::string_view rest = trimmed(item);
    if (take_phrase(rest, word)) return true;
  }
  return false;
}

/// "Both pillows" and "the three chairs": takes the count where a plural follows.
void take_meant_count(std::string_view& item, const Vocabulary& vocabulary, SelectionTerm& term) {
  std::string_view rest = item;
  const int count = take_count(rest);
  if (count == 0 || !names_several(noun_of(rest, vocabulary), vocabulary)) return;
  for (const std::string_view word : {"of the", "of my", "of these", "of those"}) take_phrase(rest, word);
  item = rest;
  term.count = count;
}

/// "The largest" and "the second largest".
void take_ranked_choice(std::string_view& item, SelectionTerm& term) {
  std::string_view rest = item;
  const int rank = take_ordinal(rest);
  term.choice = take_choice(rest);
  if (term.choice == ObjectChoice::kNone) return;
  if (rank > 0) term.rank = rank;
  item = rest;
}

/// Takes "of the two" off "the largest of the two lamps", where a plural follows.
bool take_among(std::string_view& item, const Vocabulary& vocabulary, SelectionTerm& term) {
  std::string_view rest = item;
  if (!take_phrase(rest, "one")) take_phrase(rest, "ones");
  if (!take_phrase(rest, "of all") && !take_phrase(rest, "of") && !take_phrase(rest, "among")) return false;
  std::string_view after = rest;
  if (const int count = take_count(after); count > 0) {
    term.among = count;
    rest = after;
  }
  rest = without_quantifier(rest);
  take_phrase(rest, "the");
  if (!vocabulary.is_plural(noun_of(rest, vocabulary))) {
    term.among = 0;
    return false;
  }
  item = rest;
  return true;
}

/// "The largest two pillows" are two. "The largest pillows" are how many? So are "every large pillow", "tall furniture".
void take_chosen_count(std::string_view& item, const Vocabulary& vocabulary, SelectionTerm& term, bool of_all) {
  if (take_among(item, vocabulary, term)) return;
  if (term.count == 0) take_meant_count(item, vocabulary, term);
  const std::string word = choice_word(term.choice);
  if (term.count > 0 && term.rank > 1)
    throw_usage("\"" + ordinal_text(term.rank) + " " + word + "\" means one object", "leave out one of the numbers");
  if (term.count == 0 && term.rank == 1 && (names_several(item, vocabulary) || of_all)) {
    const bool is_furniture = folded_name(item) == "furniture";  // has no plural
    const std::string name(is_furniture ? "pieces of furniture" : item);
    throw_usage("\"" + word + " " + name + "\" does not tell how many are meant",
                "say \"the two " + word + " " + name + "\", or name one of them");
  }
}

/// "The second", "the first two" or "the last" of a row that begins at a side.
void take_number_in_row(std::string_view& item, SelectionTerm& term, ObjectChoice side) {
  const std::string whole(item);
  term.choice = side;
  take_phrase(item, "the");
  std::string_view rest = item;
  if (take_phrase(rest, "last")) {
    term.choice = opposite(side);
  } else if (const int rank = take_ordinal(rest); rank > 0) {
    std::string_view more = rest;
    const int count = take_count(more);
    if (rank == 1 && count > 1) {
      rest = more;
      term.count = count;
    } else {
      term.rank = rank;
    }
  } else if (term.count == 0) {
    throw_usage("\"" + whole + "\" does not tell how many to count from the " + choice_word(side),
                "say \"the second " + whole + " from the " + choice_word(side) + "\"");
  }
  item = rest;
}

void take_colors(std::string_view& item, const Vocabulary& vocabulary, SelectionTerm& term) {
  if (!term.color.empty() || vocabulary.find(item)) return;
  std::string_view rest = item;
  const std::string color = take_color_word(rest);
  if (color.empty() || !vocabulary.find(noun_of(rest, vocabulary))) return;
  term.color = color;
  item = rest;
}

}  // namespace

void take_adjectives(std::string_view& item, const Vocabulary& vocabulary, SelectionTerm& term) {
  const bool is_a = means_any_one(item, vocabulary), of_all = asks_for_all(item);
  if (is_a) {
    if (!take_one_of(item)) item = without_a(item);
    term.count = 1;  // "a lamp" is none of two, and a number or a size tells which
  } else if (!vocabulary.find(item)) {
    take_meant_count(item, vocabulary, term);
    item = without_quantifier(item);
  }
  if (vocabulary.find(item)) return;
  if (const ObjectChoice side = take_side(item); side != ObjectChoice::kNone) {
    take_number_in_row(item, term, side);
    take_colors(item, vocabulary, term);
    return;
  }
  term.choice = take_place(item);
  const bool is_one = !vocabulary.is_plural(noun_of(item, vocabulary)) && !begins_with_quantifier(item);
  take_colors(item, vocabulary, term);
  if (!vocabulary.find(item) && term.choice == ObjectChoice::kNone) take_ranked_choice(item, term);
  if (is_a && term.choice != ObjectChoice::kNone) term.count = 0;
  if (term.choice != ObjectChoice::kNone) take_chosen_count(item, vocabulary, term, of_all);
  take_colors(item, vocabulary, term);
  if (!term.color.empty() && is_one && term.count == 0 && term.choice == ObjectChoice::kNone) term.count = 1;
}

std::string_view noun_of(std::string_view item, const Vocabulary& vocabulary) {
  item = trimmed(item);
  for (size_t length = 0; length != item.size() && !vocabulary.find(item);) {
    length = item.size();
    take_one_of(item);
    item = without_quantifier(without_a(item));
    take_phrase(item, "the");
    if (vocabulary.find(item)) break;
    take_count(item);
    if (take_ordinal(item) == 0 && !vocabulary.find(item) && take_color_word(item).empty()) take_choice(item);
    for (const std::string_view word : {"one of", "ones of", "of all", "of", "among"}) {
      std::string_view rest = item;
      if (take_phrase(rest, word) && begins_with_article(rest)) item = rest;
    }
  }
  return item;
}

bool is_adjective_alone(std::string_view item, const Vocabulary& vocabulary) {
  constexpr std::string_view kNothing = "zzz";  // no class is called so
  if (vocabulary.find(item) || trimmed(item).empty()) return false;
  const std::string text = std::string(trimmed(item)) + " " + std::string(kNothing);
  const std::string_view noun = noun_of(text, vocabulary);
  return noun == kNothing && lower_case(trimmed(item)) != "the" && lower_case(trimmed(item)) != "a";
}

std::string with_name(std::string_view items, const std::string& name) {
  std::string text(trimmed(items));
  constexpr std::string_view kOnes = "the ones", kOne = "one";
  if (const size_t at = find_word(text, kOnes); at != std::string::npos) text.replace(at, kOnes.size(), "all " + name);
  // "One lamp" at the begin is a count.
  for (size_t at = find_word(text, kOne, 1); at != std::string::npos; at = find_word(text, kOne, at + name.size()))
    text.replace(at, kOne.size(), name);
  const std::string longer = text + " " + name;
  std::string_view rest = text, object = longer;
  const bool is_choice_alone = take_choice(rest) == ObjectChoice::kNone && take_choice(object) != ObjectChoice::kNone;
  return is_choice_alone && object == name ? longer : text;
}

bool means_any_one(std::string_view item, const Vocabulary& vocabulary) {
  if (vocabulary.find(item) && !begins_with_article(item)) return false;
  std::string_view rest = trimmed(item);
  if (take_one_of(rest)) return vocabulary.find(noun_of(rest, vocabulary)).has_value();
  rest = without_a(item);
  return rest != trimmed(item) && !vocabulary.is_plural(rest);
}

bool begins_with_article(std::string_view item) {
  item = trimmed(item);
  for (const std::string_view word : {"the", "a", "an", "my", "our", "your", "all", "these", "those", "this", "that"}) {
    std::string_view rest = item;
    if (take_phrase(rest, word)) return true;
  }
  return false;
}

bool counts_from_side(std::string_view item) {
  item = trimmed(item);
  return take_side(item) != ObjectChoice::kNone;
}

}  // namespace aligngs
