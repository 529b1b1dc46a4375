#include "scene/photo_lookup.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "core/testing/error.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class PhotoLookupTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("lookup_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void file(const std::string& name) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "x";
  }
  /// Path of what was found, relative to the folder, or the problem.
  std::string found(const std::string& name) const {
    const PhotoLookup::Answer answer = photos_of_data_set(folder).find(name);
    return answer.file.empty() ? answer.problem : answer.file.lexically_relative(folder).generic_string();
  }
  fs::path folder;
};

TEST_F(PhotoLookupTest, SubfoldersWithEqualNamesAreKeptApart) {
  file("images/left/0001.jpg");
  file("images/right/0001.jpg");
  EXPECT_EQ(found("left/0001.jpg"), "images/left/0001.jpg");
  EXPECT_EQ(found("right\\0001.jpg"), "images/right/0001.jpg");
  EXPECT_EQ(found("images/right/0001.jpg"), "images/right/0001.jpg");
  EXPECT_EQ(found("/home/somebody/capture/images/right/0001.jpg"), "images/right/0001.jpg");
  EXPECT_THAT(found("0001.jpg"), HasSubstr("several photos"));
  EXPECT_THAT(found("middle/0001.jpg"), HasSubstr("missing"));  // another folder is another photo
}

TEST_F(PhotoLookupTest, ExtensionsMayDifferInCaseAndKind) {
  file("images/a.JPG");
  file("images/b.png");
  file("images/r_0.5.png");
  EXPECT_EQ(found("a.jpg"), "images/a.JPG");
  EXPECT_EQ(found("b.tif"), "images/b.png");
  EXPECT_EQ(found("./images/r_0.5"), "images/r_0.5.png");
  file("images/a.png");
  EXPECT_EQ(found("a.jpg"), "images/a.JPG");  // the same extension in another case goes first
  EXPECT_THAT(found("a.heic"), HasSubstr("several photos"));
}

TEST_F(PhotoLookupTest, NamesInLatinOneAreFoundAsUtf8AndBack) {
  file(
      "images/K\xc3\xbc"
      "che.jpg");
  file("images/T\xfcr.jpg");
  EXPECT_EQ(found("K\xfc"
                  "che.jpg"),
            "images/K\xc3\xbc"
            "che.jpg");
  EXPECT_EQ(found("T\xc3\xbcr.png"), "images/T\xfcr.jpg");
  EXPECT_EQ(view_name_of("left\\T\xfcr.jpg"), "left/T\xc3\xbcr");
}

TEST_F(PhotoLookupTest, OtherSpellingsOfANameAreFoundWhereOneFileHasThem) {
  file("images/Ku\u0308che/Bild 1.JPG");  // as macOS writes it
  EXPECT_EQ(found("K\u00fcche/bild 1.jpg"), "images/Ku\u0308che/Bild 1.JPG");
  EXPECT_EQ(found("/Users/x/K\u00dcche/k\u00fcche/Bild 1.jpg"), "images/Ku\u0308che/Bild 1.JPG");
  EXPECT_THAT(found("Kuche/Bild 1.jpg"), HasSubstr("missing"));
  file("images/a.jpg");
  file("images/A.jpg");
  EXPECT_EQ(found("A.jpg"), "images/A.jpg");  // the name as written goes first
  file("images/b1.png");
  file("images/B1.png");
  EXPECT_THAT(found("b1.jpg"), "images/b1.png");
  file("images/IMG_7.jpg");
  file("images/img_7.jpg");
  EXPECT_THAT(found("Img_7.jpg"), HasSubstr("several photos"));
}

TEST_F(PhotoLookupTest, HiddenFilesAreNoPhotos) {
  file("images/._a.jpg");
  file("images/.thumbnails/a.jpg");
  EXPECT_THAT(found("a.jpg"), HasSubstr("missing"));
}

TEST_F(PhotoLookupTest, WithoutAFolderImagesEachSubfolderCounts) {
  file("input/a.jpg");
  file("other/b.jpg");
  file("input/b.jpg");
  EXPECT_EQ(found("a.jpg"), "input/a.jpg");
  EXPECT_THAT(found("b.jpg"), HasSubstr("several photos"));
}

TEST_F(PhotoLookupTest, MasksAreNoPhotos) {
  file("input/a.jpg");
  file("masks/a.jpg");
  EXPECT_EQ(found("a.jpg"), "input/a.jpg");
}

TEST_F(PhotoLookupTest, NamesOfWebAddressesAreFound) {
  file("images/my K\u00fcche.jpg");
  EXPECT_EQ(found("images/my%20K%C3%BCche.jpg"), "images/my K\u00fcche.jpg");
  EXPECT_EQ(found("file:///C:/capture/images/my%20K%c3%bcche.jpg"), "images/my K\u00fcche.jpg");
  file("images/50%20.jpg");
  EXPECT_EQ(found("50%20.jpg"), "images/50%20.jpg");  // the name as written goes first
}

/// The error of a search as somebody without the rights of root meets it; `barred` may not be read.
std::string error_of_search(const char* barred, const std::string& name) {
  const fs::path place = fs::temp_directory_path() / ("aligngs_barred_lookup_" + std::to_string(::getpid()));
  fs::create_directories(place / "images" / "left");
  std::ofstream(place / "images" / "left" / "0.jpg") << "x";
  fs::permissions(place / barred, fs::perms::none);
  constexpr uid_t kOther = 65534;
  const bool root = ::geteuid() == 0;
  EXPECT_TRUE(!root || ::seteuid(kOther) == 0);
  const std::string message = error_of(ErrorKind::kBadInput, [&] { photos_of_data_set(place).find(name); });
  EXPECT_TRUE(!root || ::seteuid(0) == 0);
  fs::permissions(place / barred, fs::perms::owner_all);
  fs::remove_all(place);
  return message;
}

TEST_F(PhotoLookupTest, AFolderThatMayNotBeReadIsNamed) {
  EXPECT_THAT(error_of_search("images", "left/0.jpg"), HasSubstr("images: this place may not be read: Permission"));
}

TEST_F(PhotoLookupTest, ASubfolderThatMayNotBeReadIsNamed) {
  EXPECT_THAT(error_of_search("images/left", "left/0.jpg"), HasSubstr("left: this place may not be read: Permission"));
}

TEST_F(PhotoLookupTest, AnAbsoluteNameMeetsTheBarredSubfolderAsWell) {
  EXPECT_THAT(error_of_search("images/left", "/home/somebody/images/left/0.jpg"),
              HasSubstr("left: this place may not be read: Permission"));
}

}  // namespace
}  // namespace aligngs
