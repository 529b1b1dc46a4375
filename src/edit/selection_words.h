// Words around a name in a selection: "every", "the largest", "bed#1-3".
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace aligngs {

/// One object of a class by its look, instead of by its number.
enum class ObjectChoice {
  kNone,
  kLargest,
  kSmallest,
  kLeft,
  kRight,
  kHighest,
  kLowest,
  kTallest,
  kShortest,
  kWidest,
  kNarrowest,
  kMiddle,
  kDarkest,
  kLightest
};

std::string choice_word(ObjectChoice choice);  ///< "largest", "left", ...; empty for kNone

/// Takes the words of `phrase` (lower case) off the begin of `item` where more follows.
bool take_phrase(std::string_view& item, std::string_view phrase);

/// Place of `word` by itself in `text` (any case), from `from` on; npos when nowhere. Blanks and commas part words.
size_t find_word(std::string_view text, std::string_view word, size_t from = 0);

/// Place and length of the first "and", "or", "&", "+", "plus" or "as well as" that is a word of `text`, from `from` on.
/// npos and 0 when there is none.
std::pair<size_t, size_t> find_conjunction(std::string_view text, size_t from = 0);

/// Likewise the first of "but", "except", "apart from", "other than", ..., with a "not" after it.
std::pair<size_t, size_t> find_exception(std::string_view text);

/// An item without "a", "an" or "one" before it.
std::string_view without_a(std::string_view item);

/// `item` without a quantifier at its begin: "all the beds", "my bed" and "every bed" are "beds" and "bed". A quantifier
/// alone stays.
std::string_view without_quantifier(std::string_view item);

/// Whether the item begins with a word for all objects, or for any number of them: "all", "every", "those".
bool begins_with_quantifier(std::string_view item);

/// Takes "the largest", "leftmost", ... off the begin of an item.
ObjectChoice take_choice(std::string_view& item);

/// Takes "on the left", "to the right" or "in the middle" off the end of an item.
ObjectChoice take_place(std::string_view& item);

/// Takes "both", "the two", "all three" off the begin of an item: how many are meant; 0 where it begins otherwise.
int take_count(std::string_view& item);

/// Takes "that is", "which are", "standing" and the like off the end of an item.
std::string_view without_filler(std::string_view item);

/// 2 of "second" and of "2nd", in any case; 0 of any other word.
int ordinal_number(std::string_view word);

/// "2nd" for 2.
std::string ordinal_text(int number);

/// Takes "the second" or "2nd" off the begin of an item: its number; 0 where it begins otherwise.
int take_ordinal(std::string_view& item);

/// First and last object number of "2", "two", "no. 2", "1-3" or "1 to #3"; {0, 0} for anything else. Numbers are 1 to
/// 65535.
std::pair<int, int> object_numbers(std::string_view text);

}  // namespace aligngs
