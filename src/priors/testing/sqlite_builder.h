// Small SQLite files for tests of what reads a COLMAP database.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace aligngs {

/// Builds SQLite files of one leaf page per table, by the format's description.
class SqliteBuilder {
 public:
  /// A value of a row: an integer or a text.
  struct Value {
    bool is_text = false;
    int64_t integer = 0;
    std::string text;
    Value(int64_t i) : integer(i) {}                             // NOLINT
    Value(const char* t) : is_text(true), text(t) {}             // NOLINT
    Value(std::string t) : is_text(true), text(std::move(t)) {}  // NOLINT
  };
  struct Row {
    int64_t id = 0;
    std::vector<Value> values;
  };

  void table(const std::string& name, const std::vector<Row>& rows) {
    pages_.push_back(leaf(rows, 0));
    schema_.push_back({int64_t(schema_.size() + 1), {"table", name, name, int64_t(pages_.size() + 1), "CREATE TABLE"}});
  }
  std::string file() const {
    std::string header("SQLite format 3\0", 16);
    header += char(kPage >> 8);
    header += char(kPage & 255);
    header.resize(100, '\0');
    std::string bytes = leaf(schema_, 100);
    bytes.replace(0, 100, header);
    for (const std::string& page : pages_) bytes += page;
    return bytes;
  }

 private:
  static constexpr size_t kPage = 4096;

  static std::string varint(uint64_t value) {
    std::string out(1, char(value & 0x7f));
    while (value >>= 7) out.insert(out.begin(), char(0x80 | (value & 0x7f)));
    return out;
  }
  static std::string record(const std::vector<Value>& values) {
    std::string types, body;
    for (const Value& v : values) {
      if (v.is_text) {
        types += varint(13 + 2 * v.text.size());
        body += v.text;
      } else {
        types += varint(6);
        for (int shift = 56; shift >= 0; shift -= 8) body += char(uint64_t(v.integer) >> shift);
      }
    }
    return varint(types.size() + 1) + types + body;
  }
  static std::string leaf(const std::vector<Row>& rows, size_t offset) {
    std::string page(kPage, '\0');
    size_t content = kPage;
    size_t pointer = offset + 8;
    for (const Row& row : rows) {
      const std::string payload = record(row.values);
      const std::string cell = varint(payload.size()) + varint(uint64_t(row.id)) + payload;
      content -= cell.size();
      page.replace(content, cell.size(), cell);
      page[pointer++] = char(content >> 8);
      page[pointer++] = char(content & 255);
    }
    page[offset] = 0x0d;
    page[offset + 3] = char(rows.size() >> 8);
    page[offset + 4] = char(rows.size() & 255);
    return page;
  }

  std::vector<Row> schema_;
  std::vector<std::string> pages_;
};

}  // namespace aligngs
