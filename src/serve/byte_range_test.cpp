#include "serve/byte_range.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

using Kind = AskedRange::Kind;
constexpr std::string_view kTag = "\"a1\"";

std::string part(std::string_view range, uint64_t size = 100) {
  const AskedRange asked = asked_range(range, "", kTag, size);
  if (asked.kind == Kind::kWhole) return "whole";
  return asked.kind == Kind::kPart ? content_range(asked.bytes, size) : "beyond";
}

TEST(ByteRange, NamesBothEndsOrOneOfThem) {
  EXPECT_EQ(part("bytes=0-9"), "bytes 0-9/100");
  EXPECT_EQ(part("bytes=90-"), "bytes 90-99/100");
  EXPECT_EQ(part("bytes=-10"), "bytes 90-99/100");
  EXPECT_EQ(part("bytes=5-5"), "bytes 5-5/100");
}

TEST(ByteRange, IsCutAtTheEndOfTheFile) {
  EXPECT_EQ(part("bytes=90-1000"), "bytes 90-99/100");
  EXPECT_EQ(part("bytes=-1000"), "bytes 0-99/100");
}

TEST(ByteRange, BeyondTheFileIsToldApart) {
  EXPECT_EQ(part("bytes=100-"), "beyond");
  EXPECT_EQ(part("bytes=0-", 0), "beyond");
  EXPECT_EQ(part("bytes=-0"), "beyond");
}

TEST(ByteRange, AHeaderThatIsNoRangeGivesTheWholeFile) {
  for (const char* range : {"", "bytes=", "bytes=-", "bytes=9-5", "bytes=a-b", "bytes=0-9,20-29", "lines=0-9",
                            "bytes=0x1-2", "bytes=99999999999999999999-", "bytes=+1-2"}) {
    EXPECT_EQ(part(range), "whole") << range;
  }
}

TEST(ByteRange, CountsOnlyForTheFileThatTheClientHas) {
  EXPECT_EQ(asked_range("bytes=5-", kTag, kTag, 10).kind, Kind::kPart);
  EXPECT_EQ(asked_range("bytes=5-", "\"older\"", kTag, 10).kind, Kind::kWhole);
  EXPECT_EQ(asked_range("bytes=5-", "Fri, 27 Nov 2026 03:17:43 GMT", kTag, 10).kind, Kind::kWhole);
  EXPECT_EQ(asked_range("bytes=5-", "W/\"a1\"", kTag, 10).kind, Kind::kWhole)
      << "a weak tag does not promise the same bytes";
}

TEST(EntityTag, IsFoundInAList) {
  EXPECT_TRUE(names_etag("\"x\", W/\"a1\"", kTag));
  EXPECT_TRUE(names_etag("*", kTag));
  EXPECT_FALSE(names_etag("\"x\"", kTag));
  EXPECT_FALSE(names_etag("", kTag));
}

}  // namespace
}  // namespace aligngs
