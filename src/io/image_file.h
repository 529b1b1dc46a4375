// Files of pictures: JPEG, PNG, WebP and HEIF are read, JPEG and PNG written. The content decides the format, not the
// name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"

namespace aligngs {

struct ImageInfo {
  int width = 0, height = 0;                ///< after EXIF orientation
  int channels = 0;                         ///< 1, 3 or 4
  int bit_depth = 8;                        ///< 8 or 16
  int stored_width = 0, stored_height = 0;  ///< before EXIF orientation
  int orientation = 1;                      ///< EXIF, 1 to 8
};

/// Reads the header only, of a HEIF the whole file. Error{kBadInput} for anything else.
ImageInfo read_image_info(const std::filesystem::path& path);

/// Whether the file reaches its own end, told without decoding it: a copy that broke off does not. Error{kBadInput}
/// when not.
void require_whole_picture(const std::filesystem::path& path);

/// 8-bit image with 3 or 4 (alpha) channels, EXIF orientation applied. Grey is widened to 3 channels and 16-bit PNG is
/// narrowed. CMYK is multiplied out without its colour profile.
Image<uint8_t> read_image(const std::filesystem::path& path);
Image<uint8_t> decode_image(std::string_view bytes, const std::filesystem::path& name_for_errors);
/// The same with the pixels as stored: EXIF orientation is left alone. COLMAP and nerfstudio see pictures so.
Image<uint8_t> read_stored_image(const std::filesystem::path& path);
Image<uint8_t> decode_stored_image(std::string_view bytes, const std::filesystem::path& name_for_errors);
/// The file with the same pixels stored and EXIF orientation 1, so that every program sees the stored pixels. A JPEG
/// keeps all its other bytes, others are written anew as PNG.
std::string without_orientation(std::string bytes, const std::filesystem::path& name_for_errors);
/// Whether browsers and programs of photogrammetry read it: PNG, and JPEG that is not CMYK. Scenes hold nothing else.
bool is_common_picture(std::string_view bytes, const std::filesystem::path& name_for_errors);
/// EXIF as the content of a JPEG's APP1 segment, also for other formats. Empty: none.
std::string exif_of_picture(std::string_view bytes, const std::filesystem::path& name_for_errors);

/// One-channel PNG of 8 or 16 bits, values as stored (depth in millimetres, label ids). Palette images give indices.
Image<uint16_t> read_gray_png(const std::filesystem::path& path);
Image<uint16_t> decode_gray_png(std::string_view bytes, const std::filesystem::path& name_for_errors);

/// Atomic writes. channels 1, 3 or 4.
void write_png(const std::filesystem::path& path, const Image<uint8_t>& image);
void write_png16(const std::filesystem::path& path, const Image<uint16_t>& gray);
void write_jpeg(const std::filesystem::path& path, const Image<uint8_t>& rgb, int quality = 92);
std::vector<uint8_t> encode_png(const Image<uint8_t>& image);
std::vector<uint8_t> encode_jpeg(const Image<uint8_t>& rgb, int quality = 92);

/// sRGB bytes of a float image with 1 or 3 channels, clamped and rounded.
Image<uint8_t> to_bytes(const ImageF& image);
ImageF to_float(const Image<uint8_t>& image);  ///< value / 255, channels kept

}  // namespace aligngs
