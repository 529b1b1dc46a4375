// The segments of a JPEG stream. src/io internal: use io/image_file.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace aligngs {

enum JpegMarker : uint8_t {
  kEndOfImage = 0xd9,
  kStartOfScan = 0xda,
  kApp1 = 0xe1,
  kApp14 = 0xee,
};

inline uint8_t byte_at(std::string_view bytes, size_t i) { return static_cast<uint8_t>(bytes[i]); }

inline bool is_frame_header(uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}
inline bool has_no_content(uint8_t marker) { return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8); }

/// The segments of a JPEG stream, one after the other; entropy-coded data are skipped.
class SegmentWalker {
 public:
  explicit SegmentWalker(std::string_view bytes) : bytes_(bytes) {}

  /// False at the end of the bytes, also in the middle of a segment. `content` is without marker
  /// and length.
  bool next(uint8_t& marker, std::string_view& content) {
    // Between segments only 0xff fill bytes are allowed; readers skip anything else, and so do
    // scans.
    const size_t before = position_;
    while (position_ + 1 < bytes_.size()) {
      const uint8_t code = byte_at(bytes_, position_ + 1);
      if (byte_at(bytes_, position_) == 0xff && code != 0x00 && code != 0xff) break;
      ++position_;
    }
    skipped_ = bytes_.substr(before, position_ - before);
    if (position_ + 1 >= bytes_.size()) return false;
    marker = byte_at(bytes_, position_ + 1);
    position_ += 2;
    content = {};
    if (has_no_content(marker) || marker == kEndOfImage) return true;
    if (position_ + 2 > bytes_.size()) return false;
    const size_t length = size_t(byte_at(bytes_, position_)) << 8 | byte_at(bytes_, position_ + 1);
    if (length < 2 || position_ + length > bytes_.size()) return false;
    content = bytes_.substr(position_ + 2, length - 2);
    position_ += length;
    return true;
  }

  /// The bytes between the segment before and the last one.
  std::string_view skipped() const { return skipped_; }
  /// Behind the last segment.
  size_t position() const { return position_; }

 private:
  std::string_view bytes_, skipped_;
  size_t position_ = 2;  // after the start-of-image marker
};

}  // namespace aligngs
