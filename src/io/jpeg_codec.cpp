#include "io/jpeg_codec.h"

#include <turbojpeg.h>

#include <memory>
#include <string>

#include "core/error.h"
#include "io/damaged_file.h"
#include "io/exif_orientation.h"
#include "io/image_limits.h"
#include "io/jpeg_segments.h"
#include "io/jpeg_warnings.h"

namespace aligngs {
namespace {

// A Huffman-coded block of 64 pixels takes at least one bit, so a byte holds at most 512 pixels.
// Arithmetic coding may reach a few times that.
constexpr double kMaxPixelsPerJpegByte = 4096;

struct JpegHandleDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using JpegHandle = std::unique_ptr<void, JpegHandleDeleter>;

/// Error{kBadInput} unless the last call ended with a harmless warning.
void refuse_damage(void* handle, const char* field, std::string_view bytes, const std::filesystem::path& name) {
  const std::string message = tjGetErrorStr2(handle);
  if (tjGetErrorCode(handle) != TJERR_WARNING || means_damage(message, bytes))
    throw_bad_input(name, field, message, kDamagedFileRemedy);
}

/// Light that four inks leave: each takes its share of it. `inverted`: 255 is no ink.
Image<uint8_t> rgb_of_cmyk(const Image<uint8_t>& cmyk, bool inverted) {
  Image<uint8_t> rgb(cmyk.width, cmyk.height, 3);
  for (size_t i = 0; i < rgb.pixels(); ++i) {
    const auto light = [&](size_t ink) { return inverted ? cmyk.data[4 * i + ink] : 255 - cmyk.data[4 * i + ink]; };
    for (size_t c = 0; c < 3; ++c) rgb.data[3 * i + c] = static_cast<uint8_t>((light(c) * light(3) + 127) / 255);
  }
  return rgb;
}

}  // namespace

bool is_jpeg(std::string_view bytes) { return bytes.substr(0, 3) == std::string_view("\xff\xd8\xff", 3); }

bool has_end_of_jpeg(std::string_view bytes) {
  SegmentWalker walker(bytes);
  uint8_t marker = 0;
  std::string_view content;
  bool scan_seen = false;
  while (walker.next(marker, content)) {
    scan_seen |= marker == kStartOfScan;
    if (marker == kEndOfImage) return scan_seen;
  }
  return false;
}

JpegHeader parse_jpeg_header(std::string_view bytes, const std::filesystem::path& name) {
  JpegHeader header;
  SegmentWalker walker(bytes);
  uint8_t marker = 0;
  std::string_view content;
  bool exif_seen = false;
  while (walker.next(marker, content)) {
    if (marker == kApp1 && !exif_seen && content.substr(0, 6) == std::string_view("Exif\0\0", 6)) {
      header.orientation = exif_orientation(content);
      header.exif = content;
      exif_seen = true;
    } else if (marker == kApp14 && content.substr(0, 5) == "Adobe") {
      header.adobe = true;
    } else if (is_frame_header(marker)) {
      if (content.size() < 6) throw_bad_input(name, "frame header", "too short", kDamagedFileRemedy);
      header.height = byte_at(content, 1) << 8 | byte_at(content, 2);
      header.width = byte_at(content, 3) << 8 | byte_at(content, 4);
      header.channels = byte_at(content, 5) == 1 ? 1 : 3;
      header.cmyk = byte_at(content, 5) == 4;
      header.complete = true;
    } else if (marker == kStartOfScan || marker == kEndOfImage) {
      if (!header.complete) throw_bad_input(name, "frame header", "missing", kDamagedFileRemedy);
      return header;
    }
  }
  return header;
}

Image<uint8_t> decode_jpeg(std::string_view bytes, const std::filesystem::path& name) {
  const JpegHandle handle(tjInitDecompress());
  if (!handle) throw_resources(name, "the JPEG decoder cannot start");
  int width = 0, height = 0, subsampling = 0, colorspace = 0;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const int header = tjDecompressHeader3(handle.get(), data, bytes.size(), &width, &height, &subsampling, &colorspace);
  if (header != 0) refuse_damage(handle.get(), "JPEG header", bytes, name);
  const bool cmyk = colorspace == TJCS_CMYK || colorspace == TJCS_YCCK;
  require_plausible_image(uint64_t(width), uint64_t(height), bytes.size(), kMaxPixelsPerJpegByte, name);
  if (!has_end_of_jpeg(bytes)) throw_bad_input(name, "JPEG data", "the picture is truncated", kDamagedFileRemedy);

  Image<uint8_t> image(width, height, cmyk ? 4 : 3);
  /// False where there was a warning, which may hide a later one.
  const auto decode = [&](std::string_view stream) {
    const auto* from = reinterpret_cast<const unsigned char*>(stream.data());
    const int status = tjDecompress2(handle.get(), from, stream.size(), image.data.data(), width, 0, height,
                                     cmyk ? TJPF_CMYK : TJPF_RGB, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS);
    if (status != 0) refuse_damage(handle.get(), "JPEG data", stream, name);
    return status == 0;
  };
  if (!decode(bytes)) {
    const std::string plain = without_odd_headers(bytes);
    if (plain != bytes) decode(plain);
  }
  return cmyk ? rgb_of_cmyk(image, parse_jpeg_header(bytes, name).adobe) : image;
}

std::vector<uint8_t> encode_jpeg_bytes(const Image<uint8_t>& image, int quality) {
  const JpegHandle handle(tjInitCompress());
  if (!handle) throw_resources({}, "the JPEG encoder cannot start");
  const int format = image.channels == 1 ? TJPF_GRAY : image.channels == 3 ? TJPF_RGB : TJPF_RGBA;
  unsigned char* out = nullptr;
  unsigned long size = 0;
  const int status = tjCompress2(handle.get(), image.data.data(), image.width, 0, image.height, format, &out, &size,
                                 image.channels == 1 ? TJSAMP_GRAY : TJSAMP_444, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(out, tjFree);
  if (status != 0) throw_resources({}, std::string("cannot encode a JPEG: ") + tjGetErrorStr2(handle.get()));
  return {out, out + size};
}

std::string with_exif(const std::vector<uint8_t>& jpeg, std::string_view exif) {
  constexpr size_t kStartOfImage = 2;  // bytes
  const size_t length = exif.size() + 2;
  std::string out(jpeg.begin(), jpeg.begin() + kStartOfImage);
  out += {char(0xff), char(kApp1), char(length >> 8 & 0xff), char(length & 0xff)};
  out += exif;
  out.append(jpeg.begin() + kStartOfImage, jpeg.end());
  return out;
}

}  // namespace aligngs
