// Scripts with which shells complete the command line: commands, options, values of options that have few, and files.
#pragma once

#include <string>

#include "cli/shell/command_tree.h"

namespace aligngs {

/// For bash 4 and later; needs no other package. `program` is the whole tree.
std::string bash_completion(const CommandInfo& program);
/// For zsh 5 and later: a file _aligngs in a folder of $fpath.
std::string zsh_completion(const CommandInfo& program);
/// For fish 3 and later.
std::string fish_completion(const CommandInfo& program);

}  // namespace aligngs
