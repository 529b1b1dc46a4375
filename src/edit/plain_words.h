// Other words for what the grammar of selections knows: "the bed's pillows", "the nearest lamp to the window".
#pragma once

#include <string>
#include <string_view>

#include "edit/vocabulary.h"

namespace aligngs {

/// One item between commas in the words of selection_text.h. Items that are names stay as they are. Error{kUsage} for
/// what has two readings: "the bed with the pillows".
std::string in_plain_words(std::string_view item, const Vocabulary& vocabulary);

/// "The left and right lamps" as "the left lamp and the right lamp". Other items stay as they are.
std::string with_each_name(std::string_view item, const Vocabulary& vocabulary);

}  // namespace aligngs
