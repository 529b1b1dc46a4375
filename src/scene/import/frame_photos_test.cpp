#include "scene/import/frame_photos.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "core/testing/error.h"
#include "scene/import/testing/capture_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// RGB-D whose photos lie in images/left/ and images/right/ under the same names.
class RgbdSubfolders : public CaptureTest {
 protected:
  void SetUp() override {
    CaptureTest::SetUp();
    write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
    for (const char* name : {"left/0", "left/1", "right/0", "right/1"}) frame(name);
  }
  void frame(const std::string& name) {
    image("images/" + name + ".png");
    depth("depth/" + name + ".png", uint16_t(name[0] == 'l' ? 2000 : 3000));
    write("poses/" + name + ".txt", pose_opencv());
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const CapturedFrame& frame : read_capture(folder_).frames) all.push_back(frame.name);
    return all;
  }
};

TEST_F(RgbdSubfolders, ViewsHaveThePathBelowImages) {
  EXPECT_THAT(names(), ElementsAre("left/0", "left/1", "right/0", "right/1"));
}

TEST_F(RgbdSubfolders, DepthIsThatOfTheSubfolder) {
  const Capture capture = read_capture(folder_);
  EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames.at(0)).at(5, 5), 2.0f);
  EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames.at(2)).at(5, 5), 3.0f);
}

TEST_F(RgbdSubfolders, NothingIsLeftOutOfThem) { EXPECT_THAT(reasons(read_capture(folder_)), IsEmpty()); }

TEST_F(RgbdSubfolders, PhotosInTheFolderItselfAreReadAsWell) {
  frame("a");
  EXPECT_THAT(names(), ElementsAre("a", "left/0", "left/1", "right/0", "right/1"));
}

TEST_F(RgbdSubfolders, NumbersOfNamesAreInOrder) {
  frame("left/10");
  EXPECT_THAT(names(), ElementsAre("left/0", "left/1", "left/10", "right/0", "right/1"));
}

TEST_F(RgbdSubfolders, APhotoWithoutItsPoseIsLeftOut) {
  fs::remove(folder_ / "poses" / "right" / "1.txt");
  EXPECT_THAT(reasons(read_capture(folder_)), ElementsAre(HasSubstr("right/1: poses/right/1.txt: it has no pose")));
}

TEST_F(RgbdSubfolders, APoseWithoutItsPhotoIsListed) {
  write("poses/left/7.txt", pose_opencv());
  EXPECT_THAT(reasons(read_capture(folder_)), ElementsAre("left/7: the photo is missing"));
}

TEST_F(RgbdSubfolders, HiddenFilesAreNoPhotos) {
  image("images/left/._0.png");
  EXPECT_THAT(reasons(read_capture(folder_)), ElementsAre("left/._0.png: a hidden file is no photo"));
}

TEST_F(RgbdSubfolders, MasksAndHiddenFoldersAreNotSearched) {
  image("images/masks/left/0.png");
  image("images/.thumbnails/0.png");
  EXPECT_EQ(names().size(), 4u);
}

TEST_F(RgbdSubfolders, AFolderWithoutPhotosHasNone) {
  Capture capture;
  fs::create_directories(folder_ / "empty");
  EXPECT_THAT(list_photos_below(capture, folder_ / "empty"), testing::SizeIs(0));
  EXPECT_THAT(list_photos_below(capture, folder_ / "absent"), testing::SizeIs(0));
}

/// A capture in which one folder may not be read, as somebody without the rights of root meets it.
class BarredPhotos : public testing::Test {
 protected:
  void SetUp() override {
    place_ = fs::temp_directory_path() / fmt::format("aligngs_barred_photos_{}", ::getpid());
    fs::remove_all(place_);
    for (const char* folder : {"images/left", "poses/left", "depth/left"}) fs::create_directories(place_ / folder);
    write_png(place_ / "images" / "left" / "0.png", Image<uint8_t>(kWidth, kHeight, 3, 90));
    write_png16(place_ / "depth" / "left" / "0.png", Image<uint16_t>(kWidth, kHeight, 1, 2000));
    std::ofstream(place_ / "poses" / "left" / "0.txt") << "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    std::ofstream(place_ / "intrinsics.txt") << "30 0 16\n0 30 12\n0 0 1\n";
  }
  void TearDown() override { fs::remove_all(place_); }
  std::string error_with(const char* barred) const {
    fs::permissions(place_ / barred, fs::perms::none);
    constexpr uid_t kSomebody = 65534;
    const bool root = ::geteuid() == 0;
    EXPECT_TRUE(!root || ::seteuid(kSomebody) == 0);
    const std::string message = error_of(ErrorKind::kBadInput, [&] { read_capture(place_); });
    EXPECT_TRUE(!root || ::seteuid(0) == 0);
    fs::permissions(place_ / barred, fs::perms::owner_all);
    return message;
  }
  fs::path place_;
};

TEST_F(BarredPhotos, TheirFolderIsNamedWithTheReason) {
  EXPECT_THAT(error_with("images"), HasSubstr("images: this place may not be read: Permission denied"));
}

TEST_F(BarredPhotos, TheirSubfolderIsNamedWithTheReason) {
  EXPECT_THAT(error_with("images/left"), HasSubstr("left: this place may not be read: Permission denied"));
}

TEST_F(BarredPhotos, TheFolderOfDepthIsNamedWithTheReason) {
  EXPECT_THAT(error_with("depth"), HasSubstr("this place may not be read: Permission denied"));
}

}  // namespace
}  // namespace aligngs
