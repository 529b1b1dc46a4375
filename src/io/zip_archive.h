// ZIP archives: the directory and the entries, stored or deflated, with the 64-bit extension.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/byte_source.h"

namespace aligngs {

struct ZipEntry {
  std::string name;
  uint64_t header_offset = 0;    ///< of the local header
  uint64_t compressed_size = 0;  ///< bytes in the file
  uint64_t size = 0;             ///< bytes when read
  uint32_t checksum = 0;         ///< CRC-32 of the content
  uint16_t method = 0;           ///< 0 stored, 8 deflated
};

class ZipArchive {
 public:
  /// Reads the central directory. Error{kBadInput} when there is none, or when it is damaged, split
  /// over several disks, or names an entry twice.
  explicit ZipArchive(std::unique_ptr<ByteSource> source);

  const std::vector<ZipEntry>& entries() const { return entries_; }
  const ZipEntry* find(const std::string& name) const;  ///< nullptr when absent
  /// The content, its checksum verified. Error{kBadInput} for encrypted or damaged entries, other
  /// methods, sizes the file cannot hold, and entries of more than `limit` bytes.
  std::string read(const ZipEntry& entry, uint64_t limit = UINT64_MAX) const;
  const std::filesystem::path& name() const { return source_->name(); }

 private:
  std::unique_ptr<ByteSource> source_;
  std::vector<ZipEntry> entries_;
  std::unordered_map<std::string, size_t> index_;
};

/// The bytes of an archive with the given entries, all stored. For archives below 4 GiB
/// (Error{kFailed} above). The content of each entry starts at a multiple of `alignment` bytes (USDZ: 64).
std::string make_stored_zip(const std::vector<std::pair<std::string, std::string_view>>& entries, size_t alignment = 1);

}  // namespace aligngs
