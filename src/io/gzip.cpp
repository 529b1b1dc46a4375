#include "io/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr int kGzip = MAX_WBITS + 16;                           // zlib: write and expect gzip headers
constexpr size_t kMost = std::numeric_limits<uInt>::max() / 2;  // bytes handed to zlib at a time

struct Inflating {
  z_stream stream{};
  ~Inflating() { inflateEnd(&stream); }
};

}  // namespace

std::string gzip_compressed(std::string_view bytes, int level) {
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw_resources({}, "no memory for compression");
  }
  std::string out;
  std::string block(size_t(1) << 16, '\0');
  size_t taken = 0;
  int state = Z_OK;
  do {
    if (stream.avail_in == 0 && taken < bytes.size()) {
      const size_t part = std::min(kMost, bytes.size() - taken);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
      stream.avail_in = static_cast<uInt>(part);
      taken += part;
    }
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    state = deflate(&stream, taken == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    out.append(block.data(), block.size() - stream.avail_out);
  } while (state == Z_OK || state == Z_BUF_ERROR);
  deflateEnd(&stream);
  if (state != Z_STREAM_END) throw Error({ErrorKind::kFailed, "compression failed", {}, {}, {}});
  return out;
}

std::string gzip_expanded(std::string_view bytes, const std::filesystem::path& name, uint64_t limit) {
  Inflating inflating;
  z_stream& stream = inflating.stream;
  if (inflateInit2(&stream, kGzip) != Z_OK) throw_resources(name, "no memory for decompression");
  if (bytes.size() > kMost) throw_bad_input(name, "gzip", "the stream is too long");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  std::string block(size_t(1) << 16, '\0');
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    state = inflate(&stream, Z_NO_FLUSH);
    const size_t got = block.size() - stream.avail_out;
    if (out.size() + got > limit)
      throw_bad_input(name, "gzip", "more than " + std::to_string(limit) + " bytes come out of it");
    out.append(block.data(), got);
  }
  if (state != Z_STREAM_END) throw_bad_input(name, "gzip", "the stream is damaged or cut off");
  return out;
}

}  // namespace aligngs
