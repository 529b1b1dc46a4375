// Failed calls of the operating system on files and folders, as errors that name the place and a remedy.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "core/error.h"

namespace aligngs {

/// Advice for a write that failed with this error number (errno).
const char* remedy_for_write(int code);

/// "cannot open", with the reason of the system where errno has one.
std::string cannot_open(int code);

/// kBadInput where the path itself cannot be followed, else kResources. Such paths are links to themselves, files in the
/// place of folders, names that are too long, and folders that may not be entered.
Error error_of(const std::filesystem::filesystem_error& error);

/// The cause of a write to `place` that failed with `error`. A copy on a full disk ends with an input/output error, which
/// says nothing about the disk.
std::error_code cause_of_write(const std::error_code& error, const std::filesystem::path& place);

/// Error{kBadInput} where there is no such folder, where it is a file, and where its names may not be listed.
void require_readable_folder(const std::filesystem::path& folder, const std::string& remedy);

/// The path, or the nearest of the folders around it that exists.
std::filesystem::path nearest_existing(std::filesystem::path path);

/// Makes the folder and those that hold it; Error{kResources} where that fails.
void make_folders(const std::filesystem::path& folder);

/// Error{kResources} where the disk of `folder` has no room left. For programs of others, some of which end well with
/// half a file.
void refuse_full_disk(const std::filesystem::path& folder);

}  // namespace aligngs
