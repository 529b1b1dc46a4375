// JPEG through libjpeg-turbo. src/io internal: use io/image_file.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/image_file.h"

namespace aligngs {

bool is_jpeg(std::string_view bytes);
/// Whether an end-of-image marker follows a scan.
bool has_end_of_jpeg(std::string_view bytes);

/// Size as stored, channels and orientation, from the segments before the first scan.
struct JpegHeader {
  int width = 0, height = 0, channels = 0;
  int orientation = 1;    ///< EXIF, 1 to 8
  std::string_view exif;  ///< content of its segment, a part of the bytes; empty: none
  bool cmyk = false;
  bool adobe = false;     ///< has Adobe's segment: its CMYK is stored inverted, 255 for no ink
  bool complete = false;  ///< false: `bytes` ended before the frame header
};
JpegHeader parse_jpeg_header(std::string_view bytes, const std::filesystem::path& name);

/// RGB as stored, orientation not applied; CMYK is multiplied out, without its colour profile. A file without its end
/// is Error{kBadInput}, never a grey rest.
Image<uint8_t> decode_jpeg(std::string_view bytes, const std::filesystem::path& name);
std::vector<uint8_t> encode_jpeg_bytes(const Image<uint8_t>& image, int quality);
/// The same file with an EXIF segment of this content (at most 65533 bytes) at its beginning.
std::string with_exif(const std::vector<uint8_t>& jpeg, std::string_view exif);

}  // namespace aligngs
