#include "io/zip_writer.h"

#include <zlib.h>

#include "core/error.h"
#include "io/byte_reader.h"
#include "io/zip_format.h"

namespace aligngs {
namespace {

/// An extra field that moves what follows `end` to a multiple of `alignment`; empty where it is there already.
std::string padding(size_t end, size_t alignment) {
  constexpr size_t kHead = 4;               // identifier and size
  constexpr uint16_t kIdentifier = 0x1986;  // that of OpenUSD's writer
  size_t bytes = (alignment - end % alignment) % alignment;
  if (bytes == 0) return {};
  while (bytes < kHead) bytes += alignment;
  std::string out;
  append_little(out, kIdentifier);
  append_little(out, static_cast<uint16_t>(bytes - kHead));
  out.resize(bytes, '\0');
  return out;
}

constexpr uint64_t kLimit32 = 0xffffffff;  // beyond it the 64-bit extension would be needed

/// An entry as the file holds it.
struct PackedEntry {
  const std::string& name;
  std::string_view bytes;  ///< stored or deflated
  uint64_t size = 0;       ///< bytes when read
  uint32_t checksum = 0;   ///< of what is read
  uint16_t method = zip::kStored;
};

std::string deflated(std::string_view content, const std::string& entry) {
  z_stream stream{};
  constexpr int kMemoryLevel = 8;  // zlib's default
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw_resources(entry, "not enough memory to compress");
  }
  struct Ender {
    z_stream* stream;
    ~Ender() { deflateEnd(stream); }
  } ender{&stream};
  std::string out(deflateBound(&stream, content.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<unsigned>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<unsigned>(out.size());
  if (deflate(&stream, Z_FINISH) != Z_STREAM_END) throw_resources(entry, "the data cannot be compressed");
  out.resize(out.size() - stream.avail_out);
  return out;
}

/// Adds an entry to the archive and to its directory.
void add_entry(const PackedEntry& entry, size_t alignment, std::string& out, std::string& directory) {
  if (out.size() + entry.bytes.size() + zip::kLocalBytes + entry.name.size() + 2 * alignment > kLimit32 ||
      entry.size > kLimit32) {
    throw Error({ErrorKind::kFailed, "an archive of more than 4 GiB", {}, entry.name, ""});
  }
  // Version 2.0, no flags, the earliest date (1 January 1980) so that equal content gives equal bytes.
  std::string common;
  for (const int value : {20, 0, int(entry.method), 0, 0x21}) append_little(common, static_cast<uint16_t>(value));
  append_little(common, entry.checksum);
  append_little(common, static_cast<uint32_t>(entry.bytes.size()));
  append_little(common, static_cast<uint32_t>(entry.size));
  append_little(common, static_cast<uint16_t>(entry.name.size()));

  append_little(directory, zip::kDirectorySignature);
  append_little(directory, uint16_t(20));
  directory += common;
  directory.append(12, '\0');  // lengths of extra field and comment, disk, attributes
  append_little(directory, static_cast<uint32_t>(out.size()));
  directory += entry.name;

  append_little(out, zip::kLocalSignature);
  out += common;
  const std::string extra = padding(out.size() + 2 + entry.name.size(), alignment);
  append_little(out, static_cast<uint16_t>(extra.size()));
  out += entry.name;
  out += extra;
  out += entry.bytes;
}

std::string with_directory(std::string out, const std::string& directory, size_t entries) {
  if (entries > 65534) throw Error({ErrorKind::kFailed, "an archive of more than 65534 entries", {}, {}, ""});
  const uint64_t directory_offset = out.size();
  out += directory;
  append_little(out, zip::kEndSignature);
  append_little(out, uint32_t(0));
  append_little(out, static_cast<uint16_t>(entries));
  append_little(out, static_cast<uint16_t>(entries));
  append_little(out, static_cast<uint32_t>(directory.size()));
  append_little(out, static_cast<uint32_t>(directory_offset));
  append_little(out, uint16_t(0));
  return out;
}

}  // namespace

std::string make_stored_zip(const std::vector<std::pair<std::string, std::string_view>>& entries, size_t alignment) {
  std::string out, directory;
  for (const auto& [name, content] : entries) {
    add_entry({name, content, content.size(), zip::checksum_of(content), zip::kStored}, alignment, out, directory);
  }
  return with_directory(std::move(out), directory, entries.size());
}

std::string make_deflated_zip(const std::vector<std::pair<std::string, std::string_view>>& entries) {
  std::string out, directory;
  for (const auto& [name, content] : entries) {
    if (content.size() > kLimit32) throw Error({ErrorKind::kFailed, "an entry of more than 4 GiB", {}, name, ""});
    const std::string packed = deflated(content, name);
    add_entry({name, packed, content.size(), zip::checksum_of(content), zip::kDeflated}, 1, out, directory);
  }
  return with_directory(std::move(out), directory, entries.size());
}

}  // namespace aligngs
