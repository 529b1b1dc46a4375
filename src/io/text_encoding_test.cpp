#include "io/text_encoding.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

TEST(TextEncoding, TellsUtf8FromLatin1) {
  EXPECT_TRUE(
      is_utf8("K\xc3\xbc"
              "che_1.jpg"));
  EXPECT_TRUE(is_utf8("\xe2\x82\xac \xf0\x9f\x98\x80"));
  EXPECT_FALSE(
      is_utf8("K\xfc"
              "che_1.jpg"));
  EXPECT_FALSE(is_utf8("\xc0\xaf"));      // overlong
  EXPECT_FALSE(is_utf8("\xed\xa0\x80"));  // half of a surrogate pair
  EXPECT_FALSE(is_utf8("\xe2\x82"));      // cut
}

TEST(TextEncoding, LatinOneGoesThereAndBack) {
  EXPECT_EQ(as_utf8("K\xfc"
                    "che"),
            "K\xc3\xbc"
            "che");
  EXPECT_EQ(as_utf8("K\xc3\xbc"
                    "che"),
            "K\xc3\xbc"
            "che");
  EXPECT_EQ(latin1_of_utf8("K\xc3\xbc"
                           "che"),
            "K\xfc"
            "che");
  EXPECT_EQ(latin1_of_utf8("\xe2\x82\xac"), "");  // the euro sign has no place there
}

TEST(TextEncoding, AByteOrderMarkIsTakenOff) {
  EXPECT_EQ(without_byte_order_mark("\xef\xbb\xbf# Camera list"), "# Camera list");
  EXPECT_EQ(without_byte_order_mark("1 PINHOLE"), "1 PINHOLE");
}

TEST(TextEncoding, Utf16IsNamed) {
  EXPECT_EQ(text_of_file("\xef\xbb\xbfname\tsource", "rooms.tsv"), "name\tsource");
  for (const char* start : {"\xff\xfe#", "\xfe\xff#"}) {
    try {
      text_of_file(start, "cameras.txt");
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.details().message, "this text is in UTF-16");
    }
  }
}

TEST(TextEncoding, ZeroBytesAreNoText) {
  try {
    text_of_file(std::string_view("1 0 0\0\0\0", 8), "pose.txt");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().message, "this text holds zero bytes: it is in UTF-16, or damaged");
  }
}

}  // namespace
}  // namespace aligngs
