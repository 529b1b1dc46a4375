// Files that a reader would wait for, or never reach the end of.
#pragma once

#include <filesystem>

namespace aligngs {

/// Error{kBadInput} for a pipe that has a name, a socket or a device. A shell's pipes (/dev/fd/63 of `<(command)`,
/// /dev/stdin) have a writer and pass, as /dev/null does. Nothing is said of what is not there.
void require_no_waiting(const std::filesystem::path& file);

}  // namespace aligngs
