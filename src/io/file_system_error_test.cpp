#include "io/file_system_error.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "core/testing/error.h"
#include "io/image_file.h"
#include "io/left_out.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FileSystemError : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  const fs::path folder_ = fs::path(testing::TempDir()) / "file_system_error";
};

TEST_F(FileSystemError, ALinkToItselfLeavesOneFrameOut) {
  fs::create_symlink("photo.png", folder_ / "photo.png");
  std::vector<LeftOut> left_out;
  EXPECT_FALSE(use_or_leave_out("photo", left_out, [&] { (void)fs::is_regular_file(folder_ / "photo.png"); }));
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_THAT(left_out[0].reason, HasSubstr("photo.png: this link leads to itself"));
}

TEST_F(FileSystemError, ALinkToItselfIsBadInputWithARemedy) {
  fs::create_symlink("sparse", folder_ / "sparse");
  try {
    (void)fs::exists(folder_ / "sparse" / "cameras.bin");
    FAIL() << "no error";
  } catch (const fs::filesystem_error& error) {
    const Error told = error_of(error);
    EXPECT_EQ(told.kind(), ErrorKind::kBadInput);
    EXPECT_FALSE(told.details().remedy.empty());
  }
}

TEST_F(FileSystemError, AFolderThatCannotBeMadeIsNamed) {
  std::ofstream(folder_ / "file") << "x";
  try {
    make_folders(folder_ / "file" / "run");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kResources);
    EXPECT_THAT(error.what(), HasSubstr("file/run: the folder cannot be created: Not a directory"));
  }
}

// /proc has no free space at all.
TEST_F(FileSystemError, AnInputOutputErrorOnAFullDiskIsTheFullDisk) {
  EXPECT_EQ(cause_of_write(std::make_error_code(std::errc::io_error), "/proc/scene"), std::errc::no_space_on_device);
}

TEST_F(FileSystemError, AnInputOutputErrorElsewhereStays) {
  EXPECT_EQ(cause_of_write(std::make_error_code(std::errc::io_error), folder_), std::errc::io_error);
}

TEST_F(FileSystemError, AFileIsNoFolderOfPhotos) {
  std::ofstream(folder_ / "a.gif") << "x";
  EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { require_readable_folder(folder_ / "a.gif", "give photos"); }),
              HasSubstr("a.gif: this is neither a folder nor a video"));
}

/// The error of an action without the rights of root.
template <class Action>
std::string error_without_root(Action action) {
  constexpr uid_t kNobody = 65534;
  const bool root = ::geteuid() == 0;
  if (root && ::seteuid(kNobody) != 0) return "seteuid failed";
  const std::string message = error_of(ErrorKind::kBadInput, action);
  if (root && ::seteuid(0) != 0) return "seteuid failed";
  return message;
}

/// A folder that may be entered by all, with one in it that nobody may read.
fs::path barred_place() {
  const fs::path place = fs::temp_directory_path() / ("aligngs_barred_" + std::to_string(::getpid()));
  fs::create_directories(place / "source" / "images");
  std::ofstream(place / "a.png") << "x";
  fs::permissions(place / "source", fs::perms::none);
  fs::permissions(place / "a.png", fs::perms::none);
  return place;
}
void remove_barred(const fs::path& place) {
  fs::permissions(place / "source", fs::perms::owner_all);
  fs::remove_all(place);
}

TEST_F(FileSystemError, TheFolderThatMayNotBeReadIsNamed) {
  const fs::path place = barred_place();
  const std::string message = error_without_root([&] { require_readable_folder(place / "source", "give photos"); });
  remove_barred(place);
  EXPECT_THAT(message, HasSubstr((place / "source").string() + ": this place may not be read: Permission denied"));
}

TEST_F(FileSystemError, AFileBelowAFolderThatMayNotBeReadNamesTheFolder) {
  const fs::path place = barred_place();
  const std::string message = error_without_root([&] {
    try {
      (void)fs::is_directory(place / "source" / "images");
    } catch (const fs::filesystem_error& error) {
      throw error_of(error);
    }
  });
  remove_barred(place);
  EXPECT_THAT(message, HasSubstr((place / "source").string() + ": this place"));
}

TEST_F(FileSystemError, APhotoThatMayNotBeReadHasTheReasonOfTheSystem) {
  const fs::path place = barred_place();
  const std::string message = error_without_root([&] { read_image_info(place / "a.png"); });
  remove_barred(place);
  EXPECT_THAT(message, HasSubstr("a.png: cannot open: Permission denied"));
}

}  // namespace
}  // namespace aligngs
