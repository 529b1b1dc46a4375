// Folders that appear whole or not at all.
#pragma once

#include <filesystem>

namespace aligngs {

/// A folder that is filled under a temporary name beside its place (`<target>.tmp-<pid>`) and takes it on commit(); what
/// stood there before goes only then, and is put back when the new one cannot take its place. Without commit the
/// temporary folder is removed. Errors of the file system: Error{kResources} naming the target.
class FolderReplacement {
 public:
  explicit FolderReplacement(std::filesystem::path target);
  ~FolderReplacement();
  FolderReplacement(const FolderReplacement&) = delete;
  FolderReplacement& operator=(const FolderReplacement&) = delete;

  const std::filesystem::path& target() const { return target_; }  ///< absolute, without a trailing slash
  const std::filesystem::path& path() const { return temporary_; }
  void commit();

 private:
  std::filesystem::path target_, temporary_;
};

}  // namespace aligngs
