// The commands and options of the program as plain data: what completions and manual pages are generated from.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace aligngs {

struct OptionInfo {
  std::vector<std::string> names;    ///< "-o", "--output"; one name without dashes for a positional
  std::string description;           ///< one line
  std::string group;                 ///< heading in the help
  std::string value;                 ///< word for its value, as "TEXT" or "INT"; empty: a flag
  std::vector<std::string> choices;  ///< all values that it takes; empty: any
  std::string standard;              ///< default value; empty: none is shown
  bool required = false;
  bool positional = false;
};

struct CommandInfo {
  std::string path;         ///< "" of the program itself, else "run" or "models download"
  std::string description;  ///< one line
  std::string footer;       ///< notes, what it reads and writes, examples; help_text.h
  std::vector<OptionInfo> options;
  std::vector<CommandInfo> commands;

  std::string name() const { return path.substr(path.rfind(' ') + 1); }
};

/// The program or a command, with everything below it, in the order of the help. Hidden options are left out.
CommandInfo describe_command(const CLI::App& app, const std::string& path = "");

/// The command and all below it, each before its own commands.
std::vector<const CommandInfo*> all_commands(const CommandInfo& root);

/// "TEXT:{a,b}" as CLI11 words a value: the word before the colon, and the choices.
struct ValueWords {
  std::string value;
  std::vector<std::string> choices;
};
ValueWords value_words(const std::string& type_name);

}  // namespace aligngs
