// Failed calls of the operating system on files and folders, as errors that name the place and a remedy.
#pragma once

#include <filesystem>
#include <system_error>

#include "core/error.h"

namespace aligngs {

/// Advice for a write that failed with this error number (errno).
const char* remedy_for_write(int code);

/// kBadInput where the path itself cannot be followed, else kResources. Such paths are links to themselves, files in the
/// place of folders, names that are too long, and folders that may not be entered.
Error error_of(const std::filesystem::filesystem_error& error);

/// Makes the folder and those that hold it; Error{kResources} where that fails.
void make_folders(const std::filesystem::path& folder);

/// Error{kResources} where the disk of `folder` has no room left. For programs of others, some of which end well with
/// half a file.
void refuse_full_disk(const std::filesystem::path& folder);

}  // namespace aligngs
