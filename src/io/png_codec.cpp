#include "io/png_codec.h"

#include <spng.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "core/error.h"
#include "io/byte_reader.h"
#include "io/damaged_file.h"
#include "io/exif_orientation.h"
#include "io/image_limits.h"

namespace aligngs {
namespace {

struct ContextDeleter {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using PngContext = std::unique_ptr<spng_ctx, ContextDeleter>;

[[noreturn]] void fail(const std::filesystem::path& name, int code) {
  if (code == SPNG_EMEM) throw_resources(name, "not enough memory to decode the PNG");
  const char* what = code == SPNG_IO_EOF ? "the picture is truncated" : spng_strerror(code);
  throw_bad_input(name, "PNG data", what, kDamagedFileRemedy);
}

void require(const std::filesystem::path& name, int code) {
  if (code != 0) fail(name, code);
}

int samples_per_pixel(int color_type) {
  switch (color_type) {
    case SPNG_COLOR_TYPE_TRUECOLOR:
      return 3;
    case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA:
      return 2;
    case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA:
      return 4;
    default:
      return 1;
  }
}

PngContext open_png(std::string_view bytes, const std::filesystem::path& name) {
  PngContext context(spng_ctx_new(0));
  if (!context) throw_resources(name, "not enough memory to decode the PNG");
  constexpr size_t kMaxChunk = size_t(64) << 20;  // bytes of one ancillary chunk (profiles, texts), and of all
  require(name, spng_set_chunk_limits(context.get(), kMaxChunk, kMaxChunk));
  require(name, spng_set_png_buffer(context.get(), bytes.data(), bytes.size()));
  return context;
}

spng_ihdr checked_header(spng_ctx* context, uint64_t file_bytes, const std::filesystem::path& name) {
  spng_ihdr header{};
  require(name, spng_get_ihdr(context, &header));
  constexpr double kMaxDeflateRatio = 1032;  // zlib's documentation: the best deflate can do
  const double bits = double(samples_per_pixel(header.color_type)) * header.bit_depth;
  require_plausible_image(header.width, header.height, file_bytes, kMaxDeflateRatio * 8 / bits, name);
  return header;
}

/// A file without its end chunk has been cut off, even where the pixels happen to be all there.
void require_end(std::string_view bytes, const std::filesystem::path& name) {
  constexpr size_t kSignature = 8,
                   kFrame = 12;  // bytes; length, type and checksum frame a chunk's data
  size_t position = kSignature;
  while (bytes.size() - position >= kFrame) {
    const size_t left = bytes.size() - position - kFrame;
    const size_t length = load_number<uint32_t>(bytes.data() + position, true);
    if (length > left) break;
    if (bytes.substr(position + 4, 4) == "IEND") return;
    position += kFrame + length;
  }
  throw_bad_input(name, "PNG data", "the picture is truncated", kDamagedFileRemedy);
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.substr(0, 8) == std::string_view("\x89PNG\r\n\x1a\n", 8); }

bool has_end_of_png(std::string_view bytes) {
  constexpr size_t kSignature = 8, kAroundContent = 12;  // bytes: length, type and checksum of a chunk
  for (size_t at = kSignature; bytes.size() >= kAroundContent && at <= bytes.size() - kAroundContent;) {
    if (bytes.substr(at + 4, 4) == "IEND") return true;
    const size_t length = load_number<uint32_t>(bytes.data() + at, true);
    if (length > bytes.size() - at - kAroundContent) return false;
    at += length + kAroundContent;
  }
  return false;
}

PngHeader parse_png_header(std::string_view bytes, const std::filesystem::path& name, bool prefix_only) {
  const PngContext context = open_png(bytes, name);
  spng_ihdr ihdr{};
  int code = spng_get_ihdr(context.get(), &ihdr);
  PngHeader header;
  if (code == 0) {
    header.width = int(std::min<uint32_t>(ihdr.width, 0x7fffffff));
    header.height = int(std::min<uint32_t>(ihdr.height, 0x7fffffff));
    header.bit_depth = ihdr.bit_depth;
    spng_trns transparency{};
    code = spng_get_trns(context.get(), &transparency);
    const int type = ihdr.color_type;
    const bool alpha = code == 0 || type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA || type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
    header.channels = alpha ? 4 : type == SPNG_COLOR_TYPE_GRAYSCALE ? 1 : 3;
    if (code == SPNG_ECHUNKAVAIL) code = 0;
  }
  if (code == 0) {
    spng_exif exif{};
    code = spng_get_exif(context.get(), &exif);
    if (code == 0) {
      header.orientation = exif_orientation(std::string("Exif\0\0", 6) + std::string(exif.data, exif.length));
    } else if (code == SPNG_ECHUNKAVAIL) {
      code = 0;
    }
  }
  if (code != 0) {
    if (!prefix_only || code != SPNG_IO_EOF) fail(name, code);
    header.complete = false;
  }
  return header;
}

Image<uint8_t> decode_png(std::string_view bytes, const std::filesystem::path& name) {
  const PngContext context = open_png(bytes, name);
  const spng_ihdr header = checked_header(context.get(), bytes.size(), name);
  spng_trns transparency{};
  const bool alpha = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                     header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                     spng_get_trns(context.get(), &transparency) == 0;
  Image<uint8_t> image(int(header.width), int(header.height), alpha ? 4 : 3);
  require(name, spng_decode_image(context.get(), image.data.data(), image.data.size(),
                                  alpha ? SPNG_FMT_RGBA8 : SPNG_FMT_RGB8, alpha ? SPNG_DECODE_TRNS : 0));
  require_end(bytes, name);
  return image;
}

Image<uint16_t> decode_png_values(std::string_view bytes, const std::filesystem::path& name) {
  const PngContext context = open_png(bytes, name);
  const spng_ihdr header = checked_header(context.get(), bytes.size(), name);
  if (header.color_type != SPNG_COLOR_TYPE_GRAYSCALE && header.color_type != SPNG_COLOR_TYPE_INDEXED) {
    throw_bad_input(
        name, "channels",
        "a PNG with one channel is needed, this one has " + std::to_string(samples_per_pixel(header.color_type)),
        "save it as 8- or 16-bit grey");
  }
  size_t size = 0;
  require(name, spng_decoded_image_size(context.get(), SPNG_FMT_PNG, &size));
  std::vector<uint8_t> packed(size);
  require(name, spng_decode_image(context.get(), packed.data(), size, SPNG_FMT_PNG, 0));
  require_end(bytes, name);

  Image<uint16_t> image(int(header.width), int(header.height), 1);
  const unsigned depth = header.bit_depth;
  const size_t row_bytes = size / header.height;
  for (size_t y = 0; y < header.height; ++y) {
    const uint8_t* row = packed.data() + y * row_bytes;
    uint16_t* out = image.data.data() + y * header.width;
    for (size_t x = 0; x < header.width; ++x) {
      if (depth == 16) {
        uint16_t value;  // libspng gives the machine's byte order
        std::memcpy(&value, row + 2 * x, 2);
        out[x] = value;
      } else {  // 8 bits, or several pixels in a byte, the leftmost in the highest bits
        const unsigned bit = unsigned(x * depth);
        out[x] = uint16_t((row[bit / 8] >> (8 - depth - bit % 8)) & ((1u << depth) - 1));
      }
    }
  }
  return image;
}

/// zlib's: renderings become 3 % larger than with its default of 6, in a third of the time.
constexpr int kCompressionLevel = 3;

std::vector<uint8_t> encode_png_bytes(const void* pixels, size_t size, int width, int height, int channels,
                                      int bit_depth) {
  const PngContext context(spng_ctx_new(SPNG_CTX_ENCODER));
  if (!context) throw_resources({}, "not enough memory to encode a PNG");
  spng_ihdr header{};
  header.width = uint32_t(width);
  header.height = uint32_t(height);
  header.bit_depth = uint8_t(bit_depth);
  header.color_type = channels == 1   ? SPNG_COLOR_TYPE_GRAYSCALE
                      : channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR
                                      : SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  int code = spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  if (code == 0) code = spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, kCompressionLevel);
  if (code == 0) code = spng_set_ihdr(context.get(), &header);
  if (code == 0) code = spng_encode_image(context.get(), pixels, size, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  size_t encoded = 0;
  void* out = code == 0 ? spng_get_png_buffer(context.get(), &encoded, &code) : nullptr;
  const std::unique_ptr<void, void (*)(void*)> owner(out, std::free);
  if (code != 0 || !out) throw_resources({}, std::string("cannot encode a PNG: ") + spng_strerror(code));
  const auto* begin = static_cast<const uint8_t*>(out);
  return {begin, begin + encoded};
}

}  // namespace aligngs
