// Options of a room as text: words as a shell reads them, without variables, patterns or commands.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/shell_word.h"

namespace aligngs {

/// Splits at blanks; single quotes, double quotes and a backslash keep them. Error{kUsage} for a quote that is not
/// closed.
std::vector<std::string> split_words(std::string_view text);

/// Whether the words have an option of that name: "--memory", "--memory=2".
bool has_option(const std::vector<std::string>& words, const std::string& name);
/// Its value in either spelling; empty without one. The last one counts.
std::string option_value(const std::vector<std::string>& words, const std::string& name);

}  // namespace aligngs
