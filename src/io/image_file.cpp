#include "io/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/exif_orientation.h"
#include "io/file_system_error.h"
#include "io/foreign_content.h"
#include "io/heif_codec.h"
#include "io/image_limits.h"
#include "io/jpeg_codec.h"
#include "io/picture_format.h"
#include "io/png_codec.h"
#include "io/waiting_file.h"
#include "io/webp_codec.h"

namespace aligngs {
namespace {

[[noreturn]] void refuse_format(std::string_view bytes, const std::filesystem::path& name) {
  refuse_foreign_content(bytes, name);
  throw_bad_input(name, "", "neither a JPEG nor a PNG, WebP or HEIF", "convert the picture to JPEG or PNG");
}

ImageInfo upright_info(int width, int height, int channels, int bit_depth, int orientation) {
  ImageInfo info{width, height, channels, bit_depth, width, height, orientation};
  if (orientation_swaps_sides(orientation)) std::swap(info.width, info.height);
  return info;
}

/// Whether `bytes`, the first of the file, were enough.
bool info_of(std::string_view bytes, bool whole_file, const std::filesystem::path& name, ImageInfo& info) {
  switch (picture_format(bytes)) {
    case PictureFormat::kJpeg: {
      const JpegHeader header = parse_jpeg_header(bytes, name);
      if (!header.complete) return false;
      info = upright_info(header.width, header.height, header.channels, 8, header.orientation);
      return true;
    }
    case PictureFormat::kPng: {
      const PngHeader header = parse_png_header(bytes, name, !whole_file);
      if (!header.complete) return false;
      info = upright_info(header.width, header.height, header.channels, header.bit_depth == 16 ? 16 : 8,
                          header.orientation);
      return true;
    }
    case PictureFormat::kWebp: {
      const WebpHeader header = parse_webp_header(bytes, name, !whole_file);
      if (!header.complete) return false;
      info = upright_info(header.width, header.height, header.channels, 8, header.orientation);
      return true;
    }
    case PictureFormat::kHeif: {
      if (!whole_file) return false;  // the size may depend on boxes anywhere
      const HeifHeader header = parse_heif_header(bytes, name);
      info = upright_info(header.width, header.height, header.channels, 8, 1);
      return true;
    }
    case PictureFormat::kUnknown:
      break;
  }
  refuse_format(bytes, name);
}

template <class T>
void require_writable(const Image<T>& image, const std::filesystem::path& path) {
  const bool known = image.channels == 1 || image.channels == 3 || image.channels == 4;
  if (!known || image.width <= 0 || image.height <= 0 || image.data.size() != image.pixels() * size_t(image.channels)) {
    throw Error({ErrorKind::kFailed, "a picture to write needs pixels and 1, 3 or 4 channels", path, "", ""});
  }
}

std::string_view view_of(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ImageInfo read_image_info(const std::filesystem::path& path) {
  require_no_waiting(path);
  if (std::filesystem::is_directory(path)) throw_bad_input(path, "", "this is a folder, not a file", "name a file");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw_bad_input(path, "", cannot_open(errno), "check the path and its permissions");
  // The header is usually within the first kilobytes, but profiles and previews may precede it.
  std::string bytes;
  ImageInfo info;
  for (size_t wanted = size_t(1) << 16;; wanted *= 8) {
    const size_t have = bytes.size();
    bytes.resize(wanted);
    file.read(bytes.data() + have, static_cast<std::streamsize>(wanted - have));
    bytes.resize(have + static_cast<size_t>(file.gcount()));
    const bool whole_file = bytes.size() < wanted;
    if (info_of(bytes, whole_file, path, info)) break;
    if (whole_file) throw_bad_input(path, "header", "the file ends too early", "copy or create the file again");
  }
  // The plausible file size depends on the format and is checked when the pixels are read.
  require_plausible_image(uint64_t(info.width), uint64_t(info.height), 1, double(kMaxImagePixels), path);
  return info;
}

void require_whole_picture(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const auto whole = [&] {
    switch (picture_format(bytes)) {
      case PictureFormat::kJpeg:
        return has_end_of_jpeg(bytes);
      case PictureFormat::kPng:
        return has_end_of_png(bytes);
      case PictureFormat::kWebp:
        return has_end_of_webp(bytes);
      case PictureFormat::kHeif:
        return has_end_of_heif(bytes);
      case PictureFormat::kUnknown:
        return true;
    }
    return true;
  };
  if (!whole())
    throw_bad_input(path, "picture data", "the picture is truncated",
                    "the file is cut or damaged; copy or create it again");
}

Image<uint8_t> decode_image(std::string_view bytes, const std::filesystem::path& name_for_errors) {
  Image<uint8_t> stored = decode_stored_image(bytes, name_for_errors);
  switch (picture_format(bytes)) {
    case PictureFormat::kJpeg:
      return apply_orientation(std::move(stored), parse_jpeg_header(bytes, name_for_errors).orientation);
    case PictureFormat::kPng:
      return apply_orientation(std::move(stored), parse_png_header(bytes, name_for_errors, false).orientation);
    case PictureFormat::kWebp:
      return apply_orientation(std::move(stored), parse_webp_header(bytes, name_for_errors, false).orientation);
    default:
      return stored;
  }
}

Image<uint8_t> read_image(const std::filesystem::path& path) { return decode_image(read_file(path), path); }

Image<uint8_t> decode_stored_image(std::string_view bytes, const std::filesystem::path& name_for_errors) {
  switch (picture_format(bytes)) {
    case PictureFormat::kJpeg:
      return decode_jpeg(bytes, name_for_errors);
    case PictureFormat::kPng:
      return decode_png(bytes, name_for_errors);
    case PictureFormat::kWebp:
      return decode_webp(bytes, name_for_errors);
    case PictureFormat::kHeif:
      return decode_heif(bytes, name_for_errors);
    case PictureFormat::kUnknown:
      break;
  }
  refuse_format(bytes, name_for_errors);
}

Image<uint8_t> read_stored_image(const std::filesystem::path& path) {
  return decode_stored_image(read_file(path), path);
}

std::string without_orientation(std::string bytes, const std::filesystem::path& name_for_errors) {
  if (is_jpeg(bytes)) {
    const JpegHeader header = parse_jpeg_header(bytes, name_for_errors);
    if (header.orientation != 1) set_exif_upright(bytes, size_t(header.exif.data() - bytes.data()), header.exif.size());
    return bytes;
  }
  if (is_png(bytes) && parse_png_header(bytes, name_for_errors, false).orientation == 1) return bytes;
  const std::vector<uint8_t> plain = encode_png(decode_stored_image(bytes, name_for_errors));
  return {plain.begin(), plain.end()};
}

bool is_common_picture(std::string_view bytes, const std::filesystem::path& name_for_errors) {
  return is_png(bytes) || (is_jpeg(bytes) && !parse_jpeg_header(bytes, name_for_errors).cmyk);
}

std::string exif_of_picture(std::string_view bytes, const std::filesystem::path& name_for_errors) {
  switch (picture_format(bytes)) {
    case PictureFormat::kJpeg:
      return std::string(parse_jpeg_header(bytes, name_for_errors).exif);
    case PictureFormat::kWebp:
      return parse_webp_header(bytes, name_for_errors, false).exif;
    case PictureFormat::kHeif:
      return parse_heif_header(bytes, name_for_errors).exif;
    default:
      return {};
  }
}

Image<uint16_t> decode_gray_png(std::string_view bytes, const std::filesystem::path& name_for_errors) {
  if (!is_png(bytes)) throw_bad_input(name_for_errors, "", "not a PNG", "save it as 8- or 16-bit grey PNG");
  return decode_png_values(bytes, name_for_errors);
}

Image<uint16_t> read_gray_png(const std::filesystem::path& path) { return decode_gray_png(read_file(path), path); }

std::vector<uint8_t> encode_png(const Image<uint8_t>& image) {
  require_writable(image, {});
  return encode_png_bytes(image.data.data(), image.data.size(), image.width, image.height, image.channels, 8);
}

std::vector<uint8_t> encode_jpeg(const Image<uint8_t>& rgb, int quality) {
  require_writable(rgb, {});
  return encode_jpeg_bytes(rgb, std::clamp(quality, 1, 100));
}

void write_png(const std::filesystem::path& path, const Image<uint8_t>& image) {
  require_writable(image, path);
  write_file_atomically(path, view_of(encode_png(image)));
}

void write_png16(const std::filesystem::path& path, const Image<uint16_t>& gray) {
  require_writable(gray, path);
  const std::vector<uint8_t> bytes = encode_png_bytes(gray.data.data(), gray.data.size() * sizeof(uint16_t), gray.width,
                                                      gray.height, gray.channels, 16);
  write_file_atomically(path, view_of(bytes));
}

void write_jpeg(const std::filesystem::path& path, const Image<uint8_t>& rgb, int quality) {
  require_writable(rgb, path);
  write_file_atomically(path, view_of(encode_jpeg(rgb, quality)));
}

Image<uint8_t> to_bytes(const ImageF& image) {
  Image<uint8_t> out(image.width, image.height, image.channels);
  for (size_t i = 0; i < image.data.size(); ++i) {
    const float value = image.data[i];  // NaN becomes 0
    out.data[i] = value > 0 ? static_cast<uint8_t>(std::min(value, 1.0f) * 255.0f + 0.5f) : 0;
  }
  return out;
}

ImageF to_float(const Image<uint8_t>& image) {
  ImageF out(image.width, image.height, image.channels);
  for (size_t i = 0; i < image.data.size(); ++i) out.data[i] = float(image.data[i]) / 255.0f;
  return out;
}

}  // namespace aligngs
