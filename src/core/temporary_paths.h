// Files and folders that are half-written, and must not outlive the process where a signal ends it.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>

namespace aligngs {

/// `path` with `suffix` at the end of its name, which is cut to the 255 bytes that file systems take. The cut never
/// divides a character of UTF-8.
std::filesystem::path temporary_beside(const std::filesystem::path& path, const std::string& suffix);

/// From now on the end of the process by a signal (core/stop_signal.h) removes the file or folder at `path`. Who writes
/// there removes it in all other cases. Only `kill -9` leaves it behind, for the next command (io/abandoned_paths.h).
void note_temporary_path(const std::filesystem::path& path);
/// It is gone, or has taken its place.
void forget_temporary_path(const std::filesystem::path& path);
bool is_noted_temporary_path(const std::filesystem::path& path);

/// Held while what is finished takes its place and is forgotten here, so that the process does not end halfway.
[[nodiscard]] std::unique_lock<std::recursive_mutex> hold_temporary_paths();

/// Removes all noted paths, for a process that ends now. Another thread that notes a path, or moves one to its final
/// place, waits for ever.
void remove_temporary_paths();

}  // namespace aligngs
