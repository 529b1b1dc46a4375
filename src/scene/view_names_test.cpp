#include "scene/view_names.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

using testing::ElementsAre;

TEST(ViewNames, PathsOfLinuxAndWindowsAreAbsolute) {
  for (const char* name : {"/a/b.jpg", "C:\\a\\b.jpg", "d:/a/b.jpg", "\\\\server\\a.jpg"})
    EXPECT_TRUE(is_absolute_name(name)) << name;
  for (const char* name : {"a/b.jpg", "./a.jpg", "left/C:.jpg", "7:a.jpg"})
    EXPECT_FALSE(is_absolute_name(name)) << name;
}

TEST(ViewNames, OnlyWhatStaysBelowLeadsNowhereElse) {
  EXPECT_TRUE(leads_elsewhere("a/../../b.jpg"));
  EXPECT_TRUE(leads_elsewhere("/b.jpg"));
  EXPECT_FALSE(leads_elsewhere("a..b/c...jpg"));
}

TEST(ViewNames, BytesOfWebAddressesAreDecoded) {
  EXPECT_EQ(percent_decoded("a%20b%C3%bc.jpg"), "a b\xc3\xbc.jpg");
  for (const char* plain : {"a%", "a%2", "a%zz", "a%00", "abc"}) EXPECT_EQ(percent_decoded(plain), "") << plain;
}

TEST(ViewNames, TheSharedFoldersGo) {
  EXPECT_THAT(without_shared_folders({"C:\\x\\left\\1.jpg", "C:\\x\\right\\1.jpg"}),
              ElementsAre("left/1.jpg", "right/1.jpg"));
  EXPECT_THAT(without_shared_folders({"../x/1.jpg", "../x/2.jpg"}), ElementsAre("1.jpg", "2.jpg"));
  EXPECT_THAT(without_shared_folders({"a/1.jpg", "1.jpg"}), ElementsAre("a/1.jpg", "1.jpg"));
  EXPECT_THAT(without_shared_folders({"/x/y/1.jpg"}), ElementsAre("1.jpg"));
  EXPECT_THAT(without_shared_folders({}), ElementsAre());
}

}  // namespace
}  // namespace aligngs
