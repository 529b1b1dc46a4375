#include "io/folder_copy.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class FolderCopy : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "folder_copy";
    make_writable();
    fs::remove_all(folder_);
    write_file_atomically(from() / "images" / "a.png", "picture");
    write_file_atomically(from() / "scene.json", "{}");
  }
  void TearDown() override { make_writable(); }
  fs::path from() const { return folder_ / "from"; }
  fs::path to() const { return folder_ / "to"; }

  void protect() const {
    for (const char* file : {"images/a.png", "scene.json"}) fs::permissions(from() / file, fs::perms(0444));
    for (const char* place : {"images", ""}) fs::permissions(from() / place, fs::perms(0555));
  }
  void make_writable() const {
    std::error_code ignored;
    for (const char* place : {"", "images"}) fs::permissions(from() / place, fs::perms(0755), ignored);
  }
  fs::path folder_;
};

TEST_F(FolderCopy, ACopyOfAProtectedFolderCanBeChanged) {
  protect();
  std::error_code error;
  copy_folder(from(), to(), CopiedLinks::kFollowed, error);
  ASSERT_FALSE(error) << error.message();
  EXPECT_EQ(read_file(to() / "images" / "a.png"), "picture");
  for (const char* place : {"", "images", "images/a.png", "scene.json"})
    EXPECT_NE(fs::status(to() / place).permissions() & fs::perms::owner_write, fs::perms::none) << place;
}

TEST_F(FolderCopy, LinksAreFollowedOrKept) {
  fs::create_symlink(from() / "scene.json", from() / "link");
  std::error_code error;
  copy_folder(from(), to(), CopiedLinks::kFollowed, error);
  EXPECT_FALSE(fs::is_symlink(to() / "link"));
  EXPECT_EQ(read_file(to() / "link"), "{}");
  copy_folder(from(), folder_ / "kept", CopiedLinks::kKept, error);
  EXPECT_TRUE(fs::is_symlink(folder_ / "kept" / "link"));
}

TEST_F(FolderCopy, LinkedFilesAreOneFile) {
  std::error_code error;
  link_folder(from(), to(), error);
  ASSERT_FALSE(error);
  EXPECT_EQ(fs::hard_link_count(to() / "images" / "a.png"), 2u);
}

TEST_F(FolderCopy, AFileThatIsThereAndAPipeAreErrors) {
  std::error_code error;
  write_file_atomically(to() / "scene.json", "other");
  copy_folder(from(), to(), CopiedLinks::kFollowed, error);
  EXPECT_TRUE(error);
  EXPECT_EQ(read_file(to() / "scene.json"), "other");
  ASSERT_EQ(mkfifo((from() / "pipe").c_str(), 0600), 0);
  copy_folder(from() / "pipe", folder_ / "copy_of_pipe", CopiedLinks::kFollowed, error);
  EXPECT_TRUE(error);
}

TEST_F(FolderCopy, FoldersThatMayBeChangedAreNotProtected) {
  EXPECT_EQ(first_protected_folder(from()), "");
  EXPECT_EQ(first_protected_folder(folder_ / "nowhere"), "");
}

}  // namespace
}  // namespace aligngs
