// Errors for folders that hold no layout that is read: they say what the folder is, or which folder was meant.
#pragma once

#include <filesystem>

namespace aligngs {

/// Whether the ending is one of archives: .zip, .tar, .tgz, .gz, .7z, .rar, .r3d.
bool is_archive(const std::filesystem::path& file);

/// Error{kBadInput} unless it is a folder. An archive is named as such.
void require_capture_folder(const std::filesystem::path& folder);

/// Error{kBadInput} always. The message names the folders below, down to two levels, that hold a known layout. Else it
/// names the program whose files these are, archives that are still to be unpacked, finished models, or all layouts.
[[noreturn]] void refuse_layout(const std::filesystem::path& folder);

}  // namespace aligngs
