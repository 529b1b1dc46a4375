// Reading ZIP archives: the directory and the entries, stored or deflated, with the 64-bit extension.
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
  /// The first `bytes` of the content, or all of a shorter one; its checksum is not verified.
  std::string read_beginning(const ZipEntry& entry, uint64_t bytes) const;
  const std::filesystem::path& name() const { return source_->name(); }

 private:
  std::string raw_content(const ZipEntry& entry) const;

  std::unique_ptr<ByteSource> source_;
  std::vector<ZipEntry> entries_;
  std::unordered_map<std::string, size_t> index_;
};

}  // namespace aligngs
