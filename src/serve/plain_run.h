// A run that others may have made, before the page's server opens it for edits and pictures.
#pragma once

#include <filesystem>

namespace aligngs {

/// Error{kBadInput} when a file that edits, pictures and exports use is a link out of the run folder. The same for a
/// file that is not regular, because reading a FIFO never ends. The command line follows such links, as its user has
/// typed the path.
void require_plain_run(const std::filesystem::path& run);

}  // namespace aligngs
