// Checks of the words that were typed: empty and infinite values, options that do not exist.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace aligngs {

/// Error{kUsage} when a given option has an empty value, as an unset variable of a shell leaves it. Also for numbers
/// that are NaN or infinite, which ranges of CLI11 let through. Looks at the program and the command that was called.
void require_given_values(const CLI::App& program);

/// An option among the arguments that the called command does not have.
struct UnknownOption {
  std::string name;     ///< as typed, without a value behind "="; empty: there is none
  std::string nearest;  ///< an option of the command that is spelled alike; may be empty
};
/// Looks at words that begin with two dashes, up to a word that is "--" alone.
UnknownOption find_unknown_option(const CLI::App& program, const std::vector<std::string>& arguments);

}  // namespace aligngs
