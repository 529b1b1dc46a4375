// One edit of a run at a time, on the command line and on the page alike.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace aligngs {

/// The file that is locked while a process changes the edits of a run: RUN/control/edit.lock.
std::filesystem::path edit_lock_file(const std::filesystem::path& run);

/// Held from reading edits.json to writing it. The file is locked by the operating system, and holds
/// {"pid", "host", "since", "doing"} for those who wait. A process that dies loses its lock, whatever the file still
/// says, so that the next edit takes over.
class EditLock {
 public:
  /// Waits up to `patience` seconds for another edit to end. Those who wait see `doing`, e.g. "delete bed".
  /// Error{kUsage} naming the holder when it does not end, Error{kResources} when the file cannot be opened. A full disk
  /// leaves the record out. The wait is a stop point.
  EditLock(const std::filesystem::path& run, std::string_view doing, double patience);
  ~EditLock();
  EditLock(const EditLock&) = delete;
  EditLock& operator=(const EditLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace aligngs
