// Format: PKWARE APPNOTE.TXT 6.3.10 (sections 4.3.7 local header, 4.3.12 central directory, 4.3.14
// zip64, 4.3.16 end)
#include "io/zip_archive.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "io/byte_reader.h"
#include "io/damaged_file.h"
#include "io/zip_format.h"

namespace aligngs {
namespace {

constexpr uint32_t kEnd64Signature = 0x06064b50, kLocator64Signature = 0x07064b50;
constexpr uint64_t kLocatorBytes = 20, kEnd64Bytes = 56;
constexpr uint16_t kZip64Extra = 1, kEncryptedFlag = 1;
constexpr uint64_t kMaxDirectoryBytes = uint64_t(256) << 20;  // millions of entries
constexpr uint64_t kMaxDeflateRatio = 1032;                   // zlib's documentation: the best deflate can do

struct Directory {
  uint64_t offset = 0, bytes = 0, entries = 0;
};

Directory find_directory(const ByteSource& source) {
  constexpr uint64_t kMaxComment = 65535;
  const uint64_t tail_bytes = std::min<uint64_t>(source.size(), zip::kEndBytes + kMaxComment);
  const uint64_t tail_offset = source.size() - tail_bytes;
  const std::string tail = source.read(tail_offset, tail_bytes);
  for (size_t at = tail.size() < zip::kEndBytes ? 0 : tail.size() - zip::kEndBytes + 1; at-- > 0;) {
    if (load_number<uint32_t>(tail.data() + at, false) != zip::kEndSignature) continue;
    ByteReader end(std::string_view(tail).substr(at), source.name());
    end.take(4, "end of directory");
    const auto disk = end.little<uint16_t>("disk"), first_disk = end.little<uint16_t>("disk");
    end.take(2, "entries on this disk");
    Directory directory;
    directory.entries = end.little<uint16_t>("number of entries");
    directory.bytes = end.little<uint32_t>("size of the directory");
    directory.offset = end.little<uint32_t>("offset of the directory");
    if (end.little<uint16_t>("comment") != end.remaining()) continue;  // the signature was part of a comment
    const uint64_t end_offset = tail_offset + at;
    if (end_offset >= kLocatorBytes) {
      const std::string locator = source.read(end_offset - kLocatorBytes, kLocatorBytes);
      if (load_number<uint32_t>(locator.data(), false) == kLocator64Signature) {
        const std::string end64 = source.read(load_number<uint64_t>(locator.data() + 8, false), kEnd64Bytes);
        if (load_number<uint32_t>(end64.data(), false) != kEnd64Signature) {
          throw_bad_input(source.name(), "zip64 directory", "not where it should be", kDamagedFileRemedy);
        }
        return {load_number<uint64_t>(end64.data() + 48, false), load_number<uint64_t>(end64.data() + 40, false),
                load_number<uint64_t>(end64.data() + 32, false)};
      }
    }
    if (disk != 0 || first_disk != 0) throw_bad_input(source.name(), "disk", "archives in parts are not supported");
    return directory;
  }
  throw_bad_input(source.name(), "", "not a ZIP archive, or its end is missing", kDamagedFileRemedy);
}

/// Takes the 64-bit sizes out of the extra field, for those that did not fit in 32 bits.
void read_zip64_extra(ByteReader extra, ZipEntry& entry) {
  constexpr uint64_t kElsewhere = 0xffffffff;
  while (extra.remaining() >= 4) {
    const auto id = extra.little<uint16_t>("extra field");
    const auto length = extra.little<uint16_t>("extra field");
    if (id != kZip64Extra) {
      extra.take(length, "extra field");
      continue;
    }
    for (uint64_t* value : {&entry.size, &entry.compressed_size, &entry.header_offset}) {
      if (*value == kElsewhere) *value = extra.little<uint64_t>("zip64 sizes");
    }
    return;
  }
}

/// Decompresses `wanted` bytes, and with `whole` makes sure that there are no others.
std::string inflate_bytes(const std::string& compressed, uint64_t wanted, bool whole, const ZipEntry& entry,
                          const std::filesystem::path& name) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw_resources(name, "not enough memory to decompress");
  struct Ender {
    z_stream* stream;
    ~Ender() { inflateEnd(stream); }
  } ender{&stream};
  std::string content(wanted, '\0');
  constexpr size_t kMaxPart = std::numeric_limits<unsigned>::max();
  size_t in = 0, out = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    const size_t in_part = std::min(compressed.size() - in, kMaxPart),
                 out_part = std::min(content.size() - out, kMaxPart);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data() + in));
    stream.avail_in = static_cast<unsigned>(in_part);
    stream.next_out = reinterpret_cast<Bytef*>(content.data() + out);
    stream.avail_out = static_cast<unsigned>(out_part);
    status = inflate(&stream, Z_NO_FLUSH);
    in += in_part - stream.avail_in;
    out += out_part - stream.avail_out;
    if (!whole && out == content.size()) return content;
  }
  if (status != Z_STREAM_END || out != content.size() || in != compressed.size()) {
    throw_bad_input(name, entry.name, "the compressed data are damaged", kDamagedFileRemedy);
  }
  return content;
}

}  // namespace

ZipArchive::ZipArchive(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
  const Directory directory = find_directory(*source_);
  if (directory.bytes > kMaxDirectoryBytes || directory.entries > directory.bytes / zip::kDirectoryBytes) {
    throw_bad_input(name(), "directory", "the number of entries cannot be right", kDamagedFileRemedy);
  }
  const std::string bytes = source_->read(directory.offset, directory.bytes);
  ByteReader reader(bytes, name());
  entries_.reserve(directory.entries);
  for (uint64_t i = 0; i < directory.entries; ++i) {
    if (reader.little<uint32_t>("directory") != zip::kDirectorySignature)
      reader.fail("directory", "an entry is damaged");
    ZipEntry entry;
    reader.take(4, "directory");  // versions
    const auto flags = reader.little<uint16_t>("directory");
    entry.method = reader.little<uint16_t>("directory");
    reader.take(4, "directory");  // time, date
    entry.checksum = reader.little<uint32_t>("directory");
    entry.compressed_size = reader.little<uint32_t>("directory");
    entry.size = reader.little<uint32_t>("directory");
    const auto name_bytes = reader.little<uint16_t>("directory"), extra_bytes = reader.little<uint16_t>("directory"),
               comment_bytes = reader.little<uint16_t>("directory");
    reader.take(8, "directory");  // disk, attributes
    entry.header_offset = reader.little<uint32_t>("directory");
    entry.name = reader.take(name_bytes, "entry name");
    read_zip64_extra(ByteReader(reader.take(extra_bytes, "extra field"), name()), entry);
    reader.take(comment_bytes, "entry comment");
    if (flags & kEncryptedFlag) throw_bad_input(name(), entry.name, "encrypted entries are not supported");
    if (!index_.emplace(entry.name, entries_.size()).second) {
      throw_bad_input(name(), entry.name, "the archive holds this entry twice", kDamagedFileRemedy);
    }
    entries_.push_back(std::move(entry));
  }
}

const ZipEntry* ZipArchive::find(const std::string& entry_name) const {
  const auto found = index_.find(entry_name);
  return found == index_.end() ? nullptr : &entries_[found->second];
}

/// The bytes of the entry as they are stored, once its sizes are found plausible.
std::string ZipArchive::raw_content(const ZipEntry& entry) const {
  const std::string header = source_->read(entry.header_offset, zip::kLocalBytes);
  if (load_number<uint32_t>(header.data(), false) != zip::kLocalSignature) {
    throw_bad_input(name(), entry.name, "the entry is not where the directory says", kDamagedFileRemedy);
  }
  const uint64_t data_offset = entry.header_offset + zip::kLocalBytes +
                               load_number<uint16_t>(header.data() + 26, false) +
                               load_number<uint16_t>(header.data() + 28, false);
  if (entry.method != zip::kStored && entry.method != zip::kDeflated) {
    throw_bad_input(name(), entry.name, "unknown compression method " + std::to_string(entry.method));
  }
  if (entry.method == zip::kStored ? entry.size != entry.compressed_size
                                   : entry.size / kMaxDeflateRatio > entry.compressed_size) {
    throw_bad_input(name(), entry.name, "the sizes contradict each other", kDamagedFileRemedy);
  }
  return source_->read(data_offset, entry.compressed_size);
}

std::string ZipArchive::read(const ZipEntry& entry, uint64_t limit) const {
  if (entry.size > limit) {
    throw_bad_input(name(), entry.name, "larger than " + std::to_string(limit) + " bytes");
  }
  std::string content = raw_content(entry);
  if (entry.method == zip::kDeflated) content = inflate_bytes(content, entry.size, true, entry, name());
  if (zip::checksum_of(content) != entry.checksum) {
    throw_bad_input(name(), entry.name, "the checksum does not match: the data are damaged", kDamagedFileRemedy);
  }
  return content;
}

std::string ZipArchive::read_beginning(const ZipEntry& entry, uint64_t bytes) const {
  const uint64_t wanted = std::min(bytes, entry.size);
  std::string content = raw_content(entry);
  if (entry.method == zip::kDeflated) return inflate_bytes(content, wanted, false, entry, name());
  content.resize(wanted);
  return content;
}

}  // namespace aligngs
