#include "io/drawn_picture.h"

#include <zlib.h>

#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

constexpr size_t kAfterHeader = 33;            // bytes of a PNG's signature and IHDR chunk; texts may follow
constexpr size_t kSearched = size_t(4) << 20;  // bytes: tables of a long video come before its comment

void append_big(std::string& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xff);
}

/// A tEXt chunk: length, type, keyword, zero, text, checksum of type and content.
std::string mark_chunk() {
  const std::string typed = std::string("tEXtSoftware") + '\0' + kDrawnMark;
  std::string chunk;
  append_big(chunk, static_cast<uint32_t>(typed.size() - 4));
  chunk += typed;
  append_big(chunk, static_cast<uint32_t>(
                        crc32(0, reinterpret_cast<const Bytef*>(typed.data()), static_cast<uInt>(typed.size()))));
  return chunk;
}

}  // namespace

void write_drawn_picture(const std::filesystem::path& path, const Image<uint8_t>& image) {
  const std::vector<uint8_t> png = encode_png(image);
  std::string bytes(png.begin(), png.end());
  bytes.insert(kAfterHeader, mark_chunk());
  write_file_atomically(path, bytes);
}

void write_drawn_jpeg(const std::filesystem::path& path, const Image<uint8_t>& rgb, int quality) {
  const std::vector<uint8_t> jpeg = encode_jpeg(rgb, quality);
  std::string bytes(jpeg.begin(), jpeg.end());
  const std::string_view mark = kDrawnMark;
  std::string segment = "\xff\xfe";  // a comment: its length with these two bytes, then the text
  segment += '\0';
  segment += static_cast<char>(mark.size() + 2);
  segment += mark;
  // After the start and the segment of JFIF, which comes first: two bytes, then a marker of two and its length.
  const size_t jfif = 4 + (static_cast<size_t>(jpeg[4]) << 8 | jpeg[5]);
  bytes.insert(jfif, segment);
  write_file_atomically(path, bytes);
}

bool has_drawn_mark(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // reading a pipe would wait
  std::ifstream file(path, std::ios::binary);
  std::string head(kSearched, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(file.gcount()));
  return head.find(kDrawnMark) != std::string::npos;
}

}  // namespace aligngs
