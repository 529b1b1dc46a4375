// Temporary files and folders of processes that were killed.
//
// A process that writes `target` uses a name beside it that holds its process id (core/temporary_paths.h):
//   <target>.tmp-<pid>-<n>  a file (io/atomic_file.h)        <target>.tmp-<pid>       a folder or a video
//   <target>.tmp-<pid>.old  the folder that is replaced      <target>.tmp-<pid>.log   messages of a video's program
//   <target>.work-<pid>     files on the way to a scene
// `kill -9` leaves them. The next process that writes the same target removes them. They are abandoned where no process
// has that id and none holds a lock on them. The lock (flock) protects those of other containers and machines.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

/// Whether a name has the form of those above.
bool is_temporary_name(const std::string& name);

/// Marks what this process writes: the lock ends with the descriptor, or with the process. File systems without locks
/// change nothing.
void lock_temporary(int descriptor);

/// A locked folder.
class TemporaryFolderLock {
 public:
  explicit TemporaryFolderLock(const std::filesystem::path& folder);
  ~TemporaryFolderLock();
  TemporaryFolderLock(const TemporaryFolderLock&) = delete;
  TemporaryFolderLock& operator=(const TemporaryFolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// Removes what dead processes left for `target`, with a line each. A replaced folder whose successor never took its
/// place is put back. Nothing is thrown: what cannot be removed stays.
void remove_abandoned(const std::filesystem::path& target);

/// The same for a file among many: the folder is listed for the first target in it alone.
void remove_abandoned_file(const std::filesystem::path& target);

/// The same for all targets directly in `folder`.
void remove_abandoned_in(const std::filesystem::path& folder);

}  // namespace aligngs
