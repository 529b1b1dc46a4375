// A folder beside the scene for what is needed on the way.
#pragma once

#include <filesystem>
#include <optional>

#include "io/abandoned_paths.h"

namespace aligngs {

/// It is removed unless the program COLMAP failed. Then it holds the messages until the next call, alone where the first
/// attempt gave cameras.
class WorkFolder {
 public:
  /// Error{kResources} where it cannot be made.
  explicit WorkFolder(const std::filesystem::path& scene);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path log() const { return path_ / "colmap.log"; }

  bool keep = false;      ///< everything
  bool keep_log = false;  ///< log() alone

 private:
  void leave_log_alone() const;

  std::filesystem::path path_;
  std::optional<TemporaryFolderLock> lock_;
};

}  // namespace aligngs
