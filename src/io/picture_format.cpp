#include "io/picture_format.h"

#include <algorithm>
#include <cctype>

#include "io/heif_codec.h"
#include "io/jpeg_codec.h"
#include "io/png_codec.h"
#include "io/webp_codec.h"

namespace aligngs {

PictureFormat picture_format(std::string_view bytes) {
  if (is_jpeg(bytes)) return PictureFormat::kJpeg;
  if (is_png(bytes)) return PictureFormat::kPng;
  if (is_webp(bytes)) return PictureFormat::kWebp;
  if (is_heif(bytes)) return PictureFormat::kHeif;
  return PictureFormat::kUnknown;
}

const std::vector<std::string>& picture_extensions() {
  static const std::vector<std::string> extensions = {".jpg",  ".jpeg", ".jpe",  ".jfif", ".png",
                                                      ".webp", ".heic", ".heif", ".avif"};
  return extensions;
}

bool has_extension(const std::filesystem::path& file, const std::vector<std::string>& extensions) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

bool has_picture_extension(const std::filesystem::path& file) { return has_extension(file, picture_extensions()); }

bool is_video_name(const std::filesystem::path& file) {
  static const std::vector<std::string> kExtensions = {".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mts", ".3gp"};
  return has_extension(file, kExtensions);
}

}  // namespace aligngs
