#include "io/jpeg_codec.h"

#include <turbojpeg.h>

#include <memory>
#include <string>

#include "core/error.h"
#include "io/damaged_file.h"
#include "io/exif_orientation.h"
#include "io/image_limits.h"

namespace aligngs {
namespace {

// A Huffman-coded block of 64 pixels takes at least one bit, so a byte holds at most 512 pixels.
// Arithmetic coding may reach a few times that.
constexpr double kMaxPixelsPerJpegByte = 4096;

struct JpegHandleDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using JpegHandle = std::unique_ptr<void, JpegHandleDeleter>;

uint8_t byte_at(std::string_view bytes, size_t i) { return static_cast<uint8_t>(bytes[i]); }

enum Marker : uint8_t { kEndOfImage = 0xd9, kStartOfScan = 0xda, kApp1 = 0xe1, kApp14 = 0xee };

bool is_frame_header(uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}
bool stands_alone(uint8_t marker) { return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8); }

/// The segments of a JPEG stream, one after the other; entropy-coded data are skipped.
class SegmentWalker {
 public:
  explicit SegmentWalker(std::string_view bytes) : bytes_(bytes) {}

  /// False at the end of the bytes, also in the middle of a segment. `content` is without marker
  /// and length.
  bool next(uint8_t& marker, std::string_view& content) {
    // Between segments only 0xff fill bytes are allowed; readers skip anything else, and so do
    // scans.
    while (position_ + 1 < bytes_.size()) {
      const uint8_t code = byte_at(bytes_, position_ + 1);
      if (byte_at(bytes_, position_) == 0xff && code != 0x00 && code != 0xff) break;
      ++position_;
    }
    if (position_ + 1 >= bytes_.size()) return false;
    marker = byte_at(bytes_, position_ + 1);
    position_ += 2;
    content = {};
    if (stands_alone(marker) || marker == kEndOfImage) return true;
    if (position_ + 2 > bytes_.size()) return false;
    const size_t length = size_t(byte_at(bytes_, position_)) << 8 | byte_at(bytes_, position_ + 1);
    if (length < 2 || position_ + length > bytes_.size()) return false;
    content = bytes_.substr(position_ + 2, length - 2);
    position_ += length;
    return true;
  }

 private:
  std::string_view bytes_;
  size_t position_ = 2;  // after the start-of-image marker
};

/// Oddities that real cameras and editors leave and that cost no pixel.
bool is_harmless(std::string_view warning) {
  for (const std::string_view known : {"extraneous bytes before marker", "Unknown Adobe color transform",
                                       "Invalid SOS parameters for sequential JPEG"}) {
    if (warning.find(known) != std::string_view::npos) return true;
  }
  return false;
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
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colorspace = 0;
  if (tjDecompressHeader3(handle.get(), data, bytes.size(), &width, &height, &subsampling, &colorspace) != 0) {
    throw_bad_input(name, "JPEG header", tjGetErrorStr2(handle.get()), kDamagedFileRemedy);
  }
  const bool cmyk = colorspace == TJCS_CMYK || colorspace == TJCS_YCCK;
  require_plausible_image(uint64_t(width), uint64_t(height), bytes.size(), kMaxPixelsPerJpegByte, name);
  if (!has_end_of_jpeg(bytes)) throw_bad_input(name, "JPEG data", "the picture is truncated", kDamagedFileRemedy);

  Image<uint8_t> image(width, height, cmyk ? 4 : 3);
  const int status = tjDecompress2(handle.get(), data, bytes.size(), image.data.data(), width, 0, height,
                                   cmyk ? TJPF_CMYK : TJPF_RGB, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS);
  if (status != 0) {
    const std::string message = tjGetErrorStr2(handle.get());
    if (tjGetErrorCode(handle.get()) != TJERR_WARNING || !is_harmless(message)) {
      throw_bad_input(name, "JPEG data", message, kDamagedFileRemedy);
    }
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
