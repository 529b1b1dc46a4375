// Items of a selection that tell too little, or that may mean several things. Each one is Error{kUsage}.
#pragma once

#include <string_view>

namespace aligngs {

inline constexpr int kMostNumbersOfRange = 1000;  ///< objects

/// "The other chair"; `name` is "chair".
[[noreturn]] void refuse_other(std::string_view name);

/// "Every second book" may be the second one, or each second one of a row. Returns for other items.
void refuse_each_nth(std::string_view item);

/// "The left one" without a name before it. Returns where `name` is another word than "one".
void refuse_one(std::string_view whole, std::string_view name);

/// "Nearest to me": the viewer is no thing. Returns for other words.
void refuse_viewer(std::string_view anchor);

/// Wrong object numbers; `numbers` is the text behind the name.
[[noreturn]] void refuse_numbers(std::string_view whole, std::string_view numbers);

}  // namespace aligngs
