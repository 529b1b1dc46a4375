#include "io/webp_codec.h"

#include <webp/decode.h>

#include "core/error.h"
#include "io/damaged_file.h"
#include "io/exif_orientation.h"
#include "io/image_limits.h"

namespace aligngs {
namespace {

// A tile of one colour takes no bits of the lossless form, so only the format's own largest side bounds the rate.
constexpr double kMaxPixelsPerWebpByte = 16384.0 * 16384.0;

constexpr size_t kRiffHeader = 12;   // "RIFF", size, "WEBP"
constexpr size_t kChunkHeader = 8;   // name and size
constexpr uint8_t kExifFlag = 0x08;  // of the features in a VP8X chunk

size_t size_at(std::string_view bytes, size_t at) {
  size_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

/// The content of the first chunk of that name; `found` is false when the bytes end before it.
std::string_view chunk_of(std::string_view bytes, std::string_view wanted, bool& found) {
  found = false;
  for (size_t at = kRiffHeader; at + kChunkHeader <= bytes.size();) {
    const size_t size = size_at(bytes, at + 4);
    if (size > bytes.size() - at - kChunkHeader) return {};
    if (bytes.substr(at, 4) == wanted) {
      found = true;
      return bytes.substr(at + kChunkHeader, size);
    }
    at += kChunkHeader + size + (size & 1);  // chunks begin at even places
  }
  return {};
}

bool promises_exif(std::string_view bytes) {
  constexpr size_t kFeatures = kRiffHeader + kChunkHeader;
  return bytes.size() > kFeatures && bytes.substr(kRiffHeader, 4) == "VP8X" &&
         (static_cast<uint8_t>(bytes[kFeatures]) & kExifFlag);
}

}  // namespace

bool is_webp(std::string_view bytes) {
  return bytes.size() >= kRiffHeader && bytes.substr(0, 4) == "RIFF" && bytes.substr(8, 4) == "WEBP";
}

bool has_end_of_webp(std::string_view bytes) { return is_webp(bytes) && bytes.size() - 8 >= size_at(bytes, 4); }

WebpHeader parse_webp_header(std::string_view bytes, const std::filesystem::path& name, bool prefix_only) {
  WebpHeader header;
  WebPBitstreamFeatures features;
  const VP8StatusCode status = WebPGetFeatures(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), &features);
  if (status == VP8_STATUS_NOT_ENOUGH_DATA && prefix_only) {
    header.complete = false;
    return header;
  }
  if (status != VP8_STATUS_OK) throw_bad_input(name, "WebP header", "cannot be read", kDamagedFileRemedy);
  if (features.has_animation)
    throw_bad_input(name, "WebP header", "an animation is no photo", "give single pictures, or the video");
  header.width = features.width;
  header.height = features.height;
  header.channels = features.has_alpha ? 4 : 3;
  if (!promises_exif(bytes)) return header;
  bool found = false;
  const std::string_view exif = chunk_of(bytes, "EXIF", found);
  if (!found) {
    header.complete = !prefix_only;  // a whole file without the promised chunk is upright
    return header;
  }
  constexpr std::string_view kPrefix("Exif\0\0", 6);  // some writers keep that of JPEG, some leave it out
  header.exif =
      exif.substr(0, kPrefix.size()) == kPrefix ? std::string(exif) : std::string(kPrefix) + std::string(exif);
  header.orientation = exif_orientation(header.exif);
  return header;
}

Image<uint8_t> decode_webp(std::string_view bytes, const std::filesystem::path& name) {
  const WebpHeader header = parse_webp_header(bytes, name, false);
  require_plausible_image(uint64_t(header.width), uint64_t(header.height), bytes.size(), kMaxPixelsPerWebpByte, name);
  if (!has_end_of_webp(bytes)) throw_bad_input(name, "WebP data", "the picture is truncated", kDamagedFileRemedy);
  Image<uint8_t> image(header.width, header.height, header.channels);
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  const int stride = image.width * image.channels;
  const bool read = image.channels == 4
                        ? WebPDecodeRGBAInto(data, bytes.size(), image.data.data(), image.data.size(), stride)
                        : WebPDecodeRGBInto(data, bytes.size(), image.data.data(), image.data.size(), stride);
  if (!read) throw_bad_input(name, "WebP data", "cannot be decoded", kDamagedFileRemedy);
  return image;
}

}  // namespace aligngs
