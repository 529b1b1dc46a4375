#include "io/gzip.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/base64.h"

namespace aligngs {
namespace {

TEST(Gzip, GivesBackWhatItGot) {
  for (const std::string& text : {std::string(), std::string("room"), std::string(300000, 'x') + "end"}) {
    EXPECT_EQ(gzip_expanded(gzip_compressed(text), "t", 1 << 20), text);
  }
  EXPECT_EQ(gzip_compressed("room"), gzip_compressed("room"));
}

TEST(Gzip, DamageAndBombsAreBadInput) {
  const std::string good = gzip_compressed(std::string(100000, 'x'));
  std::string changed = good;
  changed[changed.size() - 6] ^= 1;  // in the checksum
  for (const std::string& bad : {std::string(), std::string("no gzip"), good.substr(0, good.size() - 9), changed}) {
    EXPECT_THROW(gzip_expanded(bad, "t", 1 << 20), Error);
  }
  EXPECT_THROW(gzip_expanded(good, "t", 1000), Error);
}

TEST(Base64, PadsTheEnd) {
  EXPECT_EQ(base64_text(""), "");
  EXPECT_EQ(base64_text("M"), "TQ==");
  EXPECT_EQ(base64_text("Ma"), "TWE=");
  EXPECT_EQ(base64_text("Man"), "TWFu");
  EXPECT_EQ(base64_text("\xff\xfe"), "//4=");
}

}  // namespace
}  // namespace aligngs
