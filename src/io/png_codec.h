// PNG through libspng. src/io internal: use io/image_file.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "io/image_file.h"

namespace aligngs {

bool is_png(std::string_view bytes);
/// Whether its chunks follow each other up to the last one, IEND.
bool has_end_of_png(std::string_view bytes);

struct PngHeader {
  int width = 0, height = 0;
  int channels = 0;      ///< 1 grey or 3 colour, 4 with transparency (also from a tRNS chunk)
  int bit_depth = 8;     ///< as stored: 1, 2, 4, 8 or 16
  int orientation = 1;   ///< from an eXIf chunk before the image data
  bool complete = true;  ///< false: `bytes` ended before the image data
};
/// With `prefix_only`, bytes that end before the image data give complete = false instead of an
/// error.
PngHeader parse_png_header(std::string_view bytes, const std::filesystem::path& name, bool prefix_only);

/// 3 channels, or 4 with transparency; orientation not applied. Missing bytes, also of the end, are
/// Error{kBadInput}.
Image<uint8_t> decode_png(std::string_view bytes, const std::filesystem::path& name);
Image<uint16_t> decode_png_values(std::string_view bytes, const std::filesystem::path& name);
std::vector<uint8_t> encode_png_bytes(const void* pixels, size_t size, int width, int height, int channels,
                                      int bit_depth);

}  // namespace aligngs
