#include "io/zip_archive.h"
#include "io/zip_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "core/error.h"
#include "io/byte_reader.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

ZipArchive open(const std::string& bytes) { return ZipArchive(memory_source(bytes, "a.zip")); }

void patch(std::string& bytes, size_t at, const std::string& with) { bytes.replace(at, with.size(), with); }

template <class T>
std::string little(T value) {
  std::string out;
  append_little(out, value);
  return out;
}

/// An archive of one entry "a", with the method, checksum and true size of `content` put into both
/// headers.
std::string deflated_zip(const std::string& content) {
  std::string compressed(compressBound(content.size()) + 16, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = unsigned(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = unsigned(compressed.size());
  deflate(&stream, Z_FINISH);
  compressed.resize(stream.total_out);
  deflateEnd(&stream);
  std::string zip = make_stored_zip({{"a", compressed}});
  const auto checksum = uint32_t(crc32(0, reinterpret_cast<const Bytef*>(content.data()), unsigned(content.size())));
  for (const size_t common : {size_t(4), zip.find("PK\x01\x02") + 6}) {
    patch(zip, common + 4, little(uint16_t(8)));
    patch(zip, common + 10, little(checksum));
    patch(zip, common + 18, little(uint32_t(content.size())));
  }
  return zip;
}

/// The same archive in the 64-bit form: sizes and offsets in extra fields, a zip64 end record and
/// its locator.
std::string as_zip64(const std::string& zip) {
  const size_t directory = zip.find("PK\x01\x02"), end = zip.find("PK\x05\x06");
  std::string entry = zip.substr(directory, end - directory);
  const auto size = load_number<uint32_t>(entry.data() + 24, false);
  patch(entry, 20, std::string(8, '\xff'));
  patch(entry, 30, little(uint16_t(28)));
  patch(entry, 42, std::string(4, '\xff'));
  entry += little(uint16_t(1)) + little(uint16_t(24)) + little(uint64_t(size)) + little(uint64_t(size)) +
           little(uint64_t(0));
  std::string out = zip.substr(0, directory) + entry;
  const size_t end64 = out.size();
  out += "PK\x06\x06" + little(uint64_t(44)) + little(uint16_t(45)) + little(uint16_t(45)) + little(uint64_t(0)) +
         little(uint64_t(1)) + little(uint64_t(1)) + little(uint64_t(entry.size())) + little(uint64_t(directory));
  out += "PK\x06\x07" + little(uint32_t(0)) + little(uint64_t(end64)) + little(uint32_t(1));
  return out + "PK\x05\x06" + std::string(4, '\0') + std::string(12, '\xff') + std::string(2, '\0');
}

void expect_bad_zip(const std::string& bytes, const std::string& message) {
  try {
    const ZipArchive archive = open(bytes);
    for (const ZipEntry& entry : archive.entries()) archive.read(entry);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "a.zip");
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(ZipArchive, ReadsStoredEntries) {
  const std::string bytes = make_stored_zip({{"x/one", "first"}, {"x/two", ""}});
  const ZipArchive archive = open(bytes);
  ASSERT_EQ(archive.entries().size(), 2u);
  EXPECT_EQ(archive.read(*archive.find("x/one")), "first");
  EXPECT_EQ(archive.read(*archive.find("x/two")), "");
  EXPECT_EQ(archive.find("three"), nullptr);
}

TEST(ZipArchive, ReadsDeflatedEntries) {
  const std::string content = std::string(5000, 'a') + "the end";
  const std::string bytes = deflated_zip(content);
  const ZipArchive archive = open(bytes);
  EXPECT_EQ(archive.read(*archive.find("a")), content);
}

TEST(ZipArchive, ReadsThe64BitForm) {
  const std::string bytes = as_zip64(make_stored_zip({{"a", "content"}}));
  const ZipArchive archive = open(bytes);
  EXPECT_EQ(archive.read(*archive.find("a")), "content");
}

TEST(ZipArchive, FindsTheEndBehindAComment) {
  std::string bytes = make_stored_zip({{"a", "content"}});
  patch(bytes, bytes.size() - 2, little(uint16_t(30)));
  bytes += "a comment with PK\x05\x06 within......";
  bytes.resize(bytes.find("a comment") + 30);
  EXPECT_EQ(open(bytes).entries().size(), 1u);
}

TEST(ZipArchive, RefusesDamage) {
  const std::string good = make_stored_zip({{"a", "content"}});
  expect_bad_zip("", "not a ZIP");
  expect_bad_zip(good.substr(0, good.size() - 1), "not a ZIP");
  std::string bytes = good;
  bytes[bytes.find("content")] ^= 1;
  expect_bad_zip(bytes, "checksum");
  bytes = good;
  bytes[0] = 'X';
  expect_bad_zip(bytes, "not where the directory says");
  bytes = deflated_zip(std::string(1000, 'a'));
  bytes[33] ^= 0x40;
  expect_bad_zip(bytes, "");
  expect_bad_zip(make_stored_zip({{"a", "1"}, {"a", "2"}}), "twice");
}

TEST(ZipArchive, RefusesContradictingOrHugeSizesBeforeAllocating) {
  const std::string good = make_stored_zip({{"a", "content"}});
  const size_t directory = good.find("PK\x01\x02");
  std::string bytes = good;
  patch(bytes, directory + 20, std::string(8, '\xfe'));  // both sizes, far beyond the file
  expect_bad_zip(bytes, "needed");
  bytes = deflated_zip("content");
  patch(bytes, bytes.find("PK\x01\x02") + 24, little(uint32_t(4000000000u)));
  expect_bad_zip(bytes, "contradict");
  bytes = good;
  patch(bytes, good.size() - 22 + 10, little(uint16_t(65000)));  // number of entries
  expect_bad_zip(bytes, "number of entries");
}

TEST(ZipArchive, RefusesWhatItDoesNotKnow) {
  const std::string good = make_stored_zip({{"a", "content"}});
  const size_t directory = good.find("PK\x01\x02");
  std::string bytes = good;
  patch(bytes, directory + 8, little(uint16_t(1)));
  expect_bad_zip(bytes, "encrypted");
  bytes = good;
  patch(bytes, directory + 10, little(uint16_t(12)));
  expect_bad_zip(bytes, "compression method 12");
}

TEST(ZipArchive, KeepsTheCallersLimit) {
  const std::string bytes = make_stored_zip({{"a", "content"}});
  const ZipArchive archive = open(bytes);
  EXPECT_THROW(archive.read(archive.entries()[0], 6), Error);
  EXPECT_NO_THROW(archive.read(archive.entries()[0], 7));
}

TEST(ZipArchive, ContentsStartAtMultiplesOfTheAlignment) {
  const std::string bytes = make_stored_zip({{"a.usda", std::string(61, 'x')}, {"second", "y"}, {"third.jpg", ""}}, 64);
  const ZipArchive zip = open(bytes);
  ASSERT_EQ(zip.entries().size(), 3u);
  for (const ZipEntry& entry : zip.entries()) {
    const size_t extra = load_number<uint16_t>(bytes.data() + entry.header_offset + 28, false);
    EXPECT_EQ((entry.header_offset + 30 + entry.name.size() + extra) % 64, 0u) << entry.name;
  }
  EXPECT_EQ(zip.read(zip.entries()[0]), std::string(61, 'x'));
  EXPECT_EQ(zip.read(zip.entries()[1]), "y");
}

}  // namespace
}  // namespace aligngs
