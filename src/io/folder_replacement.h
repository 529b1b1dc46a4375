// Folders that appear whole or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <system_error>

#include "io/abandoned_paths.h"

namespace aligngs {

/// A folder that is filled under a temporary name beside its place (`<target>.tmp-<pid>`). commit() moves it there,
/// atomically if the file system can exchange two names. A previous folder there is removed only then. Without commit
/// the temporary folder is removed. Errors of the file system: Error{kResources} naming the target, or a folder in it
/// that is protected against writing. commit() is a stop point (core/stop_signal.h).
class FolderReplacement {
 public:
  explicit FolderReplacement(const std::filesystem::path& target);
  ~FolderReplacement();
  FolderReplacement(const FolderReplacement&) = delete;
  FolderReplacement& operator=(const FolderReplacement&) = delete;

  const std::filesystem::path& target() const { return target_; }  ///< real_place() of what was given
  const std::filesystem::path& path() const { return temporary_; }
  void commit();

 private:
  void move_in_two_steps(bool replaced, std::error_code& error);

  std::filesystem::path target_, temporary_;
  std::optional<TemporaryFolderLock> lock_;
};

}  // namespace aligngs
