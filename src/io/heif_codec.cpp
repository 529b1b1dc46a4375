#include "io/heif_codec.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "core/error.h"
#include "io/damaged_file.h"
#include "io/image_limits.h"

#ifdef ALIGNGS_WITH_HEIF
#include <libheif/heif.h>
#endif

namespace aligngs {
namespace {

uint64_t big_endian(std::string_view bytes, size_t at, size_t count) {
  uint64_t value = 0;
  for (size_t i = 0; i < count; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
  return value;
}

}  // namespace

bool is_heif(std::string_view bytes) {
  // The first box of ISO base media: its size, "ftyp", the major brand (ISO/IEC 23008-12, AV1 Image File Format).
  constexpr std::array<std::string_view, 9> kBrands = {"heic", "heix", "heim", "heis", "hevc",
                                                       "hevx", "mif1", "msf1", "avif"};
  return bytes.size() >= 12 && bytes.substr(4, 4) == "ftyp" &&
         std::find(kBrands.begin(), kBrands.end(), bytes.substr(8, 4)) != kBrands.end();
}

bool has_end_of_heif(std::string_view bytes) {
  uint64_t at = 0;
  while (at < bytes.size()) {
    if (bytes.size() - at < 8) return false;
    uint64_t size = big_endian(bytes, at, 4);
    if (size == 0) return true;  // up to the end of the file
    if (size == 1) {
      if (bytes.size() - at < 16) return false;
      size = big_endian(bytes, at + 8, 8);
    }
    if (size < 8 || size > bytes.size() - at) return false;
    at += size;
  }
  return at > 0;
}

#ifdef ALIGNGS_WITH_HEIF

namespace {

// A block of 64 x 64 pixels of one colour takes a fraction of a bit in HEVC and AV1.
constexpr double kMaxPixelsPerHeifByte = 1e6;

template <auto release>
struct Releaser {
  template <class T>
  void operator()(T* object) const {
    release(object);
  }
};
using HeifContext = std::unique_ptr<heif_context, Releaser<heif_context_free>>;
using HeifHandle = std::unique_ptr<heif_image_handle, Releaser<heif_image_handle_release>>;
using Picture = std::unique_ptr<heif_image, Releaser<heif_image_release>>;
using Options = std::unique_ptr<heif_decoding_options, Releaser<heif_decoding_options_free>>;

void require_ok(const heif_error& error, const std::filesystem::path& name) {
  if (error.code == heif_error_Ok) return;
  const bool unsupported =
      error.code == heif_error_Unsupported_feature || error.code == heif_error_Unsupported_filetype;
  throw_bad_input(name, "HEIF data", error.message, unsupported ? "convert the picture to JPEG" : kDamagedFileRemedy);
}

/// The primary picture of a file.
struct Opened {
  HeifContext context{heif_context_alloc()};
  HeifHandle handle;

  Opened(std::string_view bytes, const std::filesystem::path& name) {
    if (!context) throw_resources(name, "the HEIF decoder cannot start");
    if (!has_end_of_heif(bytes)) {
      throw_bad_input(name, "HEIF data", "the picture is truncated", kDamagedFileRemedy);
    }
    require_ok(heif_context_read_from_memory_without_copy(context.get(), bytes.data(), bytes.size(), nullptr), name);
    heif_image_handle* primary = nullptr;
    require_ok(heif_context_get_primary_image_handle(context.get(), &primary), name);
    handle.reset(primary);
  }
};

/// Exif of a picture: four bytes tell where its TIFF header begins, counted from behind them (ISO/IEC 23008-12, annex
/// A).
std::string exif_of(const heif_image_handle* handle) {
  constexpr std::string_view kPrefix("Exif\0\0", 6);
  heif_item_id id = 0;
  if (heif_image_handle_get_list_of_metadata_block_IDs(handle, "Exif", &id, 1) != 1) return {};
  std::string block(heif_image_handle_get_metadata_size(handle, id), '\0');
  if (block.size() <= 4 || heif_image_handle_get_metadata(handle, id, block.data()).code != heif_error_Ok) return {};
  const uint64_t tiff = 4 + big_endian(block, 0, 4);
  return tiff < block.size() ? std::string(kPrefix) + block.substr(tiff) : std::string();
}

HeifHeader header_of(const Opened& file) {
  HeifHeader header;
  header.width = heif_image_handle_get_width(file.handle.get());
  header.height = heif_image_handle_get_height(file.handle.get());
  header.channels = heif_image_handle_has_alpha_channel(file.handle.get()) ? 4 : 3;
  header.exif = exif_of(file.handle.get());
  return header;
}

}  // namespace

bool can_decode_heif() { return true; }

HeifHeader parse_heif_header(std::string_view bytes, const std::filesystem::path& name) {
  return header_of(Opened(bytes, name));
}

Image<uint8_t> decode_heif(std::string_view bytes, const std::filesystem::path& name) {
  const Opened file(bytes, name);
  const HeifHeader header = header_of(file);
  require_plausible_image(uint64_t(header.width), uint64_t(header.height), bytes.size(), kMaxPixelsPerHeifByte, name);
  const Options options(heif_decoding_options_alloc());
  if (!options) throw_resources(name, "the HEIF decoder cannot start");
  options->convert_hdr_to_8bit = 1;
  heif_image* decoded = nullptr;
  const bool alpha = header.channels == 4;
  require_ok(heif_decode_image(file.handle.get(), &decoded, heif_colorspace_RGB,
                               alpha ? heif_chroma_interleaved_RGBA : heif_chroma_interleaved_RGB, options.get()),
             name);
  const Picture picture(decoded);
  int stride = 0;
  const uint8_t* rows = heif_image_get_plane_readonly(picture.get(), heif_channel_interleaved, &stride);
  const int width = heif_image_get_width(picture.get(), heif_channel_interleaved),
            height = heif_image_get_height(picture.get(), heif_channel_interleaved);
  if (!rows || width != header.width || height != header.height) {
    throw_bad_input(name, "HEIF data", "the picture has another size than its header", "convert the picture to JPEG");
  }
  Image<uint8_t> image(width, height, header.channels);
  const size_t row = size_t(width) * size_t(header.channels);
  for (int y = 0; y < height; ++y)
    std::memcpy(image.data.data() + size_t(y) * row, rows + size_t(y) * size_t(stride), row);
  return image;
}

#else

namespace {

[[noreturn]] void refuse(const std::filesystem::path& name) {
  throw_bad_input(name, "", "this program was built without libheif and reads no HEIC",
                  "install libheif-dev and build again, or convert the picture to JPEG");
}

}  // namespace

bool can_decode_heif() { return false; }
HeifHeader parse_heif_header(std::string_view, const std::filesystem::path& name) { refuse(name); }
Image<uint8_t> decode_heif(std::string_view, const std::filesystem::path& name) { refuse(name); }

#endif

}  // namespace aligngs
