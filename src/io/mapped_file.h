// A file mapped read-only into memory.
//
// Weights are files of several gigabytes of which a network takes one tensor at a time. Only the
// used pages of a mapped file are in memory. Several processes share them, and the kernel may drop
// them.
//
// The drawback is that a file can shrink, or its disk fail, while it is mapped. The kernel then
// answers an access with the signal SIGBUS, which ends a program that does not expect it. Comparing
// sizes first leaves a gap between the look and the access. So the mapping is never handed out:
// bytes leave it through copy(), which turns the signal into an Error. Pieces that fit a cache make
// that copy cheap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace aligngs {

class MappedFile {
 public:
  /// Error{kBadInput} when the path is no file or cannot be opened, Error{kResources} when the
  /// address space does not hold it. The first mapping installs a handler of SIGBUS for the
  /// process, which passes on what does not come from copy().
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  uint64_t size() const { return size_; }  ///< bytes, when it was opened
  /// Copies `count` bytes from `offset`; the caller has checked that both lie within size(). The
  /// pages are given back afterwards, so that they do not count as memory of this process.
  /// Error{kBadInput} when the file has become shorter or the disk fails.
  void copy(uint64_t offset, size_t count, char* out) const;

 private:
  std::filesystem::path path_;
  uint64_t size_ = 0;
  char* bytes_ = nullptr;  ///< null for an empty file
};

}  // namespace aligngs
