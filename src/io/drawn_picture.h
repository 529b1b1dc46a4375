// Pictures and videos that this program draws bear a mark, so that it replaces none of other people.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/image.h"

namespace aligngs {

/// The mark: the text "Software" of a PNG (its specification, 11.3.3.2), the comment of an MP4 or of a JPEG.
inline constexpr const char* kDrawnMark = "drawn by aligngs";

/// write_png() with the mark: for pictures whose place the user names.
void write_drawn_picture(const std::filesystem::path& path, const Image<uint8_t>& image);
/// write_jpeg() with the mark: for textures, which lie beside the file that the user names.
void write_drawn_jpeg(const std::filesystem::path& path, const Image<uint8_t>& rgb, int quality);

/// Whether the file bears the mark in its first 4 MiB. False where it cannot be read.
bool has_drawn_mark(const std::filesystem::path& path);

}  // namespace aligngs
