// SQLite's file format (sqlite.org/fileformat2.html), as far as walking a table needs it. The first
// columns of a row always lie in the row's own page, so overflow pages are never read.
#include "priors/colmap_database.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// A value of a row: an integer or a text; anything else is neither.
struct Value {
  std::optional<int64_t> integer;
  std::optional<std::string> text;
};

class SqliteFile {
 public:
  SqliteFile(std::string_view bytes, fs::path name) : bytes_(bytes), name_(std::move(name)) {
    constexpr std::string_view kMagic("SQLite format 3\0", 16);
    if (bytes_.size() < 100 || bytes_.substr(0, 16) != kMagic) fail("header", "not an SQLite file");
    page_size_ = size_t(big_endian(16, 2));
    if (page_size_ == 1) page_size_ = 65536;
    if (page_size_ < 512 || (page_size_ & (page_size_ - 1)) != 0) fail("header", "bad page size");
  }

  using Row = std::function<void(int64_t rowid, const std::vector<Value>&)>;

  /// The first `columns` columns of every row of the table.
  void for_rows(const std::string& table, size_t columns, const Row& visit) {
    uint64_t root = 0;
    // The schema: type, name, tbl_name, rootpage.
    pages_left_ = bytes_.size() / page_size_;
    walk(1, 4, [&](int64_t, const std::vector<Value>& row) {
      if (row.size() == 4 && row[0].text == "table" && row[1].text == table && row[3].integer)
        root = uint64_t(*row[3].integer);
    });
    if (root == 0) fail(table, "there is no such table");
    pages_left_ = bytes_.size() / page_size_;
    walk(root, columns, visit);
  }

 private:
  [[noreturn]] void fail(const std::string& field, const std::string& message) const {
    throw_bad_input(name_, field, message, "run `aligngs poses` again");
  }

  uint64_t big_endian(size_t at, size_t count) const {
    if (at + count > bytes_.size()) fail("page", "the file ends too early");
    uint64_t value = 0;
    for (size_t i = 0; i < count; ++i) value = value << 8 | uint8_t(bytes_[at + i]);
    return value;
  }

  uint64_t varint(size_t& at, size_t end) const {
    uint64_t value = 0;
    for (int i = 0; i < 9; ++i) {
      if (at >= end) fail("row", "it ends too early");
      const auto byte = uint8_t(bytes_[at++]);
      if (i == 8) return value << 8 | byte;
      value = value << 7 | (byte & 0x7f);
      if (!(byte & 0x80)) break;
    }
    return value;
  }

  void walk(uint64_t page, size_t columns, const Row& visit) {
    constexpr int kInterior = 0x05, kLeaf = 0x0d;
    if (page == 0 || page > bytes_.size() / page_size_) fail("page", "a number beyond the file");
    if (pages_left_-- == 0) fail("page", "pages form a circle");  // every page belongs to one table
    const size_t start = size_t(page - 1) * page_size_, end = start + page_size_;
    const size_t header = start + (page == 1 ? 100 : 0);
    const int type = int(big_endian(header, 1));
    if (type != kInterior && type != kLeaf) fail("page", "of an unexpected kind");
    const size_t cells = size_t(big_endian(header + 3, 2));
    const size_t pointers = header + (type == kInterior ? 12 : 8);
    if (pointers + 2 * cells > end) fail("page", "more rows than it can hold");
    for (size_t i = 0; i < cells; ++i) {
      const size_t cell = start + size_t(big_endian(pointers + 2 * i, 2));
      if (cell >= end) fail("page", "a row outside of it");
      if (type == kInterior)
        walk(big_endian(cell, 4), columns, visit);
      else
        row(cell, end, columns, visit);
    }
    if (type == kInterior) walk(big_endian(header + 8, 4), columns, visit);
  }

  void row(size_t at, size_t end, size_t columns, const Row& visit) const {
    varint(at, end);  // bytes of the row
    const auto rowid = int64_t(varint(at, end));
    size_t type_at = at;
    const uint64_t header_bytes = varint(type_at, end);
    if (header_bytes > end - at) fail("row", "its header does not fit");
    const size_t types_end = at + size_t(header_bytes);
    size_t value_at = types_end;
    std::vector<Value> values;
    while (type_at < types_end && values.size() < columns) {
      const uint64_t type = varint(type_at, types_end);
      constexpr uint64_t kIntegerBytes[] = {0, 1, 2, 3, 4, 6, 8};
      Value value;
      uint64_t bytes = 0;
      if (type <= 6) {
        bytes = kIntegerBytes[type];
      } else if (type == 7) {
        bytes = 8;  // a real number
      } else if (type >= 12) {
        bytes = (type - 12) / 2;
      }
      if (bytes > end - value_at) break;  // continues on another page: nothing that is asked for
      if (type >= 1 && type <= 6) {
        auto number = int64_t(big_endian(value_at, size_t(bytes)));
        const int shift = int(64 - 8 * bytes);
        value.integer = int64_t(uint64_t(number) << shift) >> shift;
      } else if (type == 8 || type == 9) {
        value.integer = int64_t(type - 8);
      } else if (type >= 13 && type % 2 == 1) {
        value.text = std::string(bytes_.substr(value_at, size_t(bytes)));
      }
      value_at += size_t(bytes);
      values.push_back(std::move(value));
    }
    visit(rowid, values);
  }

  std::string_view bytes_;
  fs::path name_;
  size_t page_size_ = 0;
  size_t pages_left_ = 0;
};

/// COLMAP numbers a pair first * kMaxPhotos + second.
constexpr int64_t kMaxPhotos = 2147483647;

}  // namespace

ColmapDatabase decode_colmap_database(std::string_view bytes, const fs::path& name_for_errors) {
  SqliteFile file(bytes, name_for_errors);
  ColmapDatabase database;
  std::map<int64_t, int64_t> features;
  file.for_rows("keypoints", 2, [&](int64_t id, const std::vector<Value>& row) {
    if (row.size() == 2 && row[1].integer) features[id] = *row[1].integer;
  });
  file.for_rows("images", 2, [&](int64_t id, const std::vector<Value>& row) {
    if (row.size() == 2 && row[1].text) database.photos.push_back({uint32_t(id), *row[1].text, features[id]});
  });
  std::map<int64_t, ColmapDatabase::Pair> pairs;
  const auto pair_of = [&](int64_t id) -> ColmapDatabase::Pair& {
    ColmapDatabase::Pair& pair = pairs[id];
    pair.first = uint32_t(id / kMaxPhotos);
    pair.second = uint32_t(id % kMaxPhotos);
    return pair;
  };
  file.for_rows("matches", 2, [&](int64_t id, const std::vector<Value>& row) {
    if (row.size() == 2 && row[1].integer) pair_of(id).matches = *row[1].integer;
  });
  file.for_rows("two_view_geometries", 2, [&](int64_t id, const std::vector<Value>& row) {
    if (row.size() == 2 && row[1].integer) pair_of(id).verified = *row[1].integer;
  });
  for (const auto& entry : pairs) database.pairs.push_back(entry.second);
  std::sort(database.photos.begin(), database.photos.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return database;
}

ColmapDatabase read_colmap_database(const fs::path& path) { return decode_colmap_database(read_file(path), path); }

}  // namespace aligngs
