// Words before a name that tell which of its objects are meant: counts, colours, sizes and sides.
#pragma once

#include <string>
#include <string_view>

#include "edit/selection_term.h"
#include "edit/vocabulary.h"

namespace aligngs {

/// Takes the counts, colours, sizes and sides off an item, and puts them into the term. The name stays, perhaps with a
/// number. Error{kUsage} for words that do not tell how many are meant.
void take_adjectives(std::string_view& item, const Vocabulary& vocabulary, SelectionTerm& term);

/// The name in an item, without any words before it: "books" of "the two largest of the red books".
std::string_view noun_of(std::string_view item, const Vocabulary& vocabulary);

/// Whether an item has words before a name, and no name: "the left", "the second".
bool is_adjective_alone(std::string_view item, const Vocabulary& vocabulary);

/// Whether an item means one object of several: "a lamp", "one of the lamps", "either lamp".
bool means_any_one(std::string_view item, const Vocabulary& vocabulary);

/// "The left one", "the ones on the rug" and "the largest" with a name in place of "one", or after the choice.
std::string with_name(std::string_view items, const std::string& name);

/// "The", "a", "my" and the like, with more after it.
bool begins_with_article(std::string_view item);

/// Whether an item ends with "from the left" or the like.
bool counts_from_side(std::string_view item);

}  // namespace aligngs
