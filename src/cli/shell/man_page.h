// Manual pages in the man(7) macros, one per command.
#pragma once

#include <string>

#include "cli/shell/command_tree.h"

namespace aligngs {

/// "aligngs-models-download.1"; "aligngs.1" of the program itself.
std::string man_page_name(const CommandInfo& command);

/// How the page of `command` begins in every version of the program. A page of other hands has a date, or another source.
std::string man_page_beginning(const CommandInfo& command);

/// The page of `command`, which is part of `program`. It has no date, so that equal sources give equal pages.
std::string man_page(const CommandInfo& command, const CommandInfo& program);

}  // namespace aligngs
