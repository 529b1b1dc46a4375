// A file that the server sends: a regular file below one folder, opened once and read through its descriptor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace aligngs {

/// Opening never blocks and touches nothing else: FIFOs, devices, sockets and folders are looked at and left closed.
/// The place is checked on the opened file, so a link that is swapped in meanwhile leads nowhere.
class ServedFile {
 public:
  /// The regular file that `relative` names below `root` (a canonical folder). Nothing when it does not exist, is no
  /// regular file, cannot be read, or lies outside through "..", an absolute path or a symbolic link.
  static std::optional<ServedFile> open(const std::filesystem::path& root, std::string_view relative);

  ~ServedFile();
  ServedFile(ServedFile&& other) noexcept;
  ServedFile& operator=(ServedFile&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }
  uint64_t size() const { return size_; }  ///< bytes, when it was opened
  /// Changes whenever the file is replaced or written: a strong ETag with its quotes.
  const std::string& etag() const { return etag_; }

  /// Fills `out` from byte `offset` on; returns how many bytes there were. 0: the end, or a failing disk.
  size_t read(uint64_t offset, std::span<char> out) const;
  /// The whole file, nothing when it has more than `limit` bytes.
  std::optional<std::string> content(uint64_t limit) const;

 private:
  ServedFile() = default;

  int descriptor_ = -1;
  std::filesystem::path path_;
  uint64_t size_ = 0;
  std::string etag_;
};

}  // namespace aligngs
