// Numbers of the ZIP format that reading and writing share (PKWARE APPNOTE.TXT 6.3.10).
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string_view>

namespace aligngs::zip {

constexpr uint32_t kLocalSignature = 0x04034b50, kDirectorySignature = 0x02014b50, kEndSignature = 0x06054b50;
constexpr uint64_t kLocalBytes = 30, kDirectoryBytes = 46, kEndBytes = 22;
constexpr uint16_t kStored = 0, kDeflated = 8;  ///< compression methods

/// CRC-32 of the content of an entry.
inline uint32_t checksum_of(std::string_view content) {
  return static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
}

}  // namespace aligngs::zip
