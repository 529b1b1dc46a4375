// HEIC, HEIF and AVIF through libheif, where the program was built with it. src/io internal: use io/image_file.h.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/image.h"

namespace aligngs {

bool is_heif(std::string_view bytes);
/// Whether the boxes of the file follow each other up to its end.
bool has_end_of_heif(std::string_view bytes);
/// Whether this program reads such files.
bool can_decode_heif();

/// Turns and mirrors of the file are part of its size: such a picture has no other orientation (ISO/IEC 23008-12).
struct HeifHeader {
  int width = 0, height = 0;
  int channels = 3;  ///< 4 with transparency
  std::string exif;  ///< as the content of a JPEG's APP1 segment; empty: none
};
/// `bytes`: the whole file. Error{kBadInput} also where the program was built without libheif.
HeifHeader parse_heif_header(std::string_view bytes, const std::filesystem::path& name);

/// The primary picture, upright, 3 channels, or 4 with transparency; more than 8 bits are narrowed.
Image<uint8_t> decode_heif(std::string_view bytes, const std::filesystem::path& name);

}  // namespace aligngs
