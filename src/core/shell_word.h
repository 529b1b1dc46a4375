// Words of commands that messages give to be typed again.
#pragma once

#include <string>
#include <vector>

namespace aligngs {

/// The word as a shell reads it back, in single quotes where it holds more than harmless characters.
std::string quote_word(const std::string& word);
std::string join_words(const std::vector<std::string>& words);

}  // namespace aligngs
