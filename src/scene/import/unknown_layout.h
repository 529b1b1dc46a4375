// Errors for folders that hold no layout that is read: they say what the folder is, or which folder was meant.
#pragma once

#include <filesystem>

namespace aligngs {

/// Error{kBadInput} unless it is a folder. An archive is named as such.
void require_capture_folder(const std::filesystem::path& folder);

/// Error{kBadInput} always. The message names the folders below, down to two levels, that hold a known layout. Else it
/// names the program whose files these are, where it is known, or all layouts that are read.
[[noreturn]] void refuse_layout(const std::filesystem::path& folder);

}  // namespace aligngs
