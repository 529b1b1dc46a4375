#include "io/file_system_error.h"

#include <gmock/gmock.h>

#include <fstream>

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

}  // namespace
}  // namespace aligngs
