// The text below the options in the help of a command, in the same form for all of them.
#pragma once

#include <string>
#include <vector>

namespace aligngs {

struct HelpText {
  const char* reads;
  const char* writes;
  const char* example;     ///< what most people type
  const char* advanced;    ///< what shows more of the options
  const char* notes = "";  ///< sentences, one a line
};

/// Notes, then "Reads:", "Writes:", "Example:" and "Advanced:", a line each.
std::string help_footer(const HelpText& text);

/// Words of an option, separated by commas. Those that differ in a last letter are one entry at the place of the first:
/// "vggt, dpt-g|l|b|s".
std::string words_in_help(const std::vector<std::string>& words);

}  // namespace aligngs
