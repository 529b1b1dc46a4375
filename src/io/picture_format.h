// The formats of pictures that are read, told by the first bytes of a file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

enum class PictureFormat { kUnknown, kJpeg, kPng, kWebp, kHeif };

/// `bytes`: the first 32 bytes of a file or more.
PictureFormat picture_format(std::string_view bytes);

/// Extensions of the formats that are read, in lower case with their dot: .jpg, .jpeg, .png, .webp, .heic, .heif,
/// .avif.
const std::vector<std::string>& picture_extensions();

/// Whether the file has one of these extensions (lower case, with their dot), in any case.
bool has_extension(const std::filesystem::path& file, const std::vector<std::string>& extensions);
/// Whether the file has one of picture_extensions().
bool has_picture_extension(const std::filesystem::path& file);

/// Whether the file has the extension of a video (.mp4, .mov, .m4v, .mkv, .webm, .avi, .mts, .3gp), in any case.
bool is_video_name(const std::filesystem::path& file);

}  // namespace aligngs
