// Words of a sentence that turn its meaning: "don't", "never", and the verb of a second edit.
#pragma once

#include <optional>
#include <string>

namespace aligngs {

/// Whether a sentence in lower case holds "don't", "do not", "never" or "not".
bool has_negation(const std::string& text);

/// The sentence behind its negation: "delete the bed" of "don't delete the bed". The same text where it begins with
/// none.
std::string behind_negation(const std::string& text);

/// The verb after "and", "then", "but" or a comma: "keep" of "delete the bed and keep the pillows". "And turn by 90" is
/// part of a move.
std::optional<std::string> second_verb(const std::string& text);

}  // namespace aligngs
