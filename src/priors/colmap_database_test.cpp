#include "priors/colmap_database.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "priors/colmap_poses.h"

namespace aligngs {
namespace {

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

constexpr int64_t pair_id(int64_t a, int64_t b) { return a * 2147483647 + b; }

/// Four photos: two that match well, one that matches neither enough, one without features.
std::string example() {
  SqliteBuilder builder;
  builder.table("images", {{1, {int64_t(0), "a.jpg"}},
                           {2, {int64_t(0), "b.jpg"}},
                           {3, {int64_t(0), "c.jpg"}},
                           {4, {int64_t(0), "dark.jpg"}}});
  builder.table("keypoints", {{1, {int64_t(0), int64_t(5000)}},
                              {2, {int64_t(0), int64_t(4000)}},
                              {3, {int64_t(0), int64_t(3000)}},
                              {4, {int64_t(0), int64_t(12)}}});
  builder.table("matches", {{pair_id(1, 2), {int64_t(0), int64_t(300)}}, {pair_id(1, 3), {int64_t(0), int64_t(40)}}});
  builder.table("two_view_geometries",
                {{pair_id(1, 2), {int64_t(0), int64_t(250)}}, {pair_id(1, 3), {int64_t(0), int64_t(9)}}});
  return builder.file();
}

TEST(ColmapDatabase, NumbersOfPhotosAndPairs) {
  const ColmapDatabase database = decode_colmap_database(example(), "test.db");
  ASSERT_EQ(database.photos.size(), 4u);
  EXPECT_EQ(database.photos[0].name, "a.jpg");
  EXPECT_EQ(database.photos[1].features, 4000);
  ASSERT_EQ(database.pairs.size(), 2u);
  EXPECT_EQ(database.pairs[0].first, 1u);
  EXPECT_EQ(database.pairs[0].second, 2u);
  EXPECT_EQ(database.pairs[0].matches, 300);
  EXPECT_EQ(database.pairs[1].verified, 9);
}

TEST(ColmapDatabase, EveryTruncationIsAnErrorOrARead) {
  const std::string whole = example();
  for (size_t length = 0; length < whole.size(); length += 97) {
    try {
      decode_colmap_database(std::string_view(whole).substr(0, length), "short.db");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    }
  }
}

TEST(ColmapDatabase, ChangedBytesNeverCrash) {
  const std::string whole = example();
  for (size_t at = 0; at < whole.size(); at += 13) {
    for (const int value : {0, 5, 255}) {
      std::string changed = whole;
      changed[at] = char(value);
      try {
        decode_colmap_database(changed, "changed.db");
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      }
    }
  }
}

TEST(ColmapDatabase, AnotherFileIsRefused) {
  EXPECT_THROW(decode_colmap_database(std::string(5000, 'x'), "x.db"), Error);
}

class WhyUnplaced : public testing::Test {
 protected:
  std::string why(const std::string& photo, const std::vector<std::string>& placed) const {
    return why_unplaced(database, photo, placed);
  }
  const ColmapDatabase database = decode_colmap_database(example(), "test.db");
};

TEST_F(WhyUnplaced, AFeaturelessPhoto) {
  EXPECT_THAT(why("dark.jpg", {"a.jpg", "b.jpg"}), testing::HasSubstr("only 12 features"));
}
TEST_F(WhyUnplaced, TooLittleOverlap) {
  EXPECT_THAT(why("c.jpg", {"a.jpg", "b.jpg"}),
              testing::AllOf(testing::HasSubstr("a.jpg"), testing::HasSubstr("only 9 points")));
}
TEST_F(WhyUnplaced, MatchesThatGaveNoPosition) {
  EXPECT_THAT(why("b.jpg", {"a.jpg"}), testing::HasSubstr("250 points with a.jpg"));
}
TEST_F(WhyUnplaced, NothingWasPlacedAtAll) {
  EXPECT_THAT(why("b.jpg", {}), testing::HasSubstr("too few for a first pair"));
}
TEST_F(WhyUnplaced, AGroupOfItsOwn) {
  EXPECT_THAT(why("b.jpg", {"c.jpg"}), testing::HasSubstr("not connected with the others"));
}

}  // namespace
}  // namespace aligngs
