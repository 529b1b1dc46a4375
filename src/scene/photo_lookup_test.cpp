#include "scene/photo_lookup.h"

#include <gmock/gmock.h>

#include <fstream>

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

}  // namespace
}  // namespace aligngs
