// WebP through libwebp. src/io internal: use io/image_file.h.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/image.h"

namespace aligngs {

bool is_webp(std::string_view bytes);
/// Whether the file is as long as its header tells.
bool has_end_of_webp(std::string_view bytes);

struct WebpHeader {
  int width = 0, height = 0;
  int channels = 3;      ///< 4 with transparency
  int orientation = 1;   ///< EXIF, 1 to 8
  std::string exif;      ///< as the content of a JPEG's APP1 segment; empty: none
  bool complete = true;  ///< false: `bytes` ended before everything above was known
};
/// With `prefix_only`, bytes that end too early give complete = false instead of an error. Error{kBadInput}: an
/// animation.
WebpHeader parse_webp_header(std::string_view bytes, const std::filesystem::path& name, bool prefix_only);

/// 3 channels, or 4 with transparency; orientation not applied. A cut file is Error{kBadInput}.
Image<uint8_t> decode_webp(std::string_view bytes, const std::filesystem::path& name);

}  // namespace aligngs
