// Files and folders that are half-written, and must not outlive the process where a signal ends it.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>

namespace aligngs {

/// `path` with `suffix` at the end of its name, which is cut where both together would be longer than the 255 bytes that file systems
/// take; never within a character of UTF-8.
std::filesystem::path temporary_beside(const std::filesystem::path& path, const std::string& suffix);

/// From now on the end of the process by a signal (core/stop_signal.h) removes what stands at `path`. Who writes there removes it in
/// all other cases. Only `kill -9` leaves it behind.
void note_temporary_path(const std::filesystem::path& path);
/// It is gone, or has taken its place.
void forget_temporary_path(const std::filesystem::path& path);

/// Held while what is finished takes its place and is forgotten here, so that the process does not end halfway.
[[nodiscard]] std::unique_lock<std::recursive_mutex> hold_temporary_paths();

/// Removes all that is noted, for a process that ends now: whoever wants to note a path, or to put one in its place, waits for ever.
void remove_temporary_paths();

}  // namespace aligngs
