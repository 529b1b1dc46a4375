#include "priors/colmap_database.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "priors/colmap_poses.h"
#include "priors/testing/sqlite_builder.h"

namespace aligngs {
namespace {

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
