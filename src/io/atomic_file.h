// Files that appear whole or not at all: temporary name, flush to disk, rename.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace aligngs {

/// Writes to `<path>.tmp-<pid>-<n>` and renames on commit(); else the temporary file is removed. Failures (full disk, no
/// permission) are Error{kResources} and leave the old file. Only files are replaced (require_file_place).
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);  ///< creates the parent folder when needed
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(const void* data, size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  void commit();  ///< fsync, rename, fsync of the folder

 private:
  void flush();

  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
  std::string buffer_;
};

void write_file_atomically(const std::filesystem::path& path, std::string_view content);
/// Whole file; Error{kBadInput} when it cannot be read or is larger than `limit` bytes.
std::string read_file(const std::filesystem::path& path, uint64_t limit = uint64_t(1) << 33);

}  // namespace aligngs
