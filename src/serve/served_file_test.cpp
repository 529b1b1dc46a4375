#include "serve/served_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class ServedFileTest : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(testing::TempDir()) /
            ("aligngs_served_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(base_);
    fs::create_directories(base_ / "run" / "mesh");
    std::ofstream(base_ / "run" / "scene.ply") << "0123456789";
    std::ofstream(base_ / "secret.txt") << "secret";
    root_ = fs::canonical(base_ / "run");
  }
  void TearDown() override { fs::remove_all(base_); }
  bool opens(std::string_view name) const { return ServedFile::open(root_, name).has_value(); }

  fs::path base_, root_;
};

TEST_F(ServedFileTest, ReadsAnyPartOfAFile) {
  const auto file = ServedFile::open(root_, "scene.ply");
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size(), 10u);
  EXPECT_EQ(file->content(10), "0123456789");
  EXPECT_EQ(file->content(9), std::nullopt) << "more than the limit";
  char part[4];
  EXPECT_EQ(file->read(8, part), 2u);
  EXPECT_EQ(std::string(part, 2), "89");
}

TEST_F(ServedFileTest, NothingOutsideTheFolderIsOpened) {
  fs::create_symlink(base_ / "secret.txt", base_ / "run" / "link.txt");
  fs::create_directory_symlink(base_, base_ / "run" / "up");
  const std::string absolute = (base_ / "secret.txt").string();
  for (const std::string& name :
       std::vector<std::string>{"", ".", "mesh", "../secret.txt", "mesh/../../secret.txt", "link.txt", "up/secret.txt",
                                absolute, "absent.ply", "../run"}) {
    EXPECT_FALSE(opens(name)) << name;
  }
  EXPECT_TRUE(opens("mesh/../scene.ply"));
}

TEST_F(ServedFileTest, ALinkThatStaysInTheFolderIsAFileOfIt) {
  fs::create_symlink("scene.ply", base_ / "run" / "same.ply");
  EXPECT_TRUE(opens("same.ply"));
}

TEST_F(ServedFileTest, AFifoIsNotWaitedFor) {
  ASSERT_EQ(mkfifo((base_ / "run" / "fifo.ply").c_str(), 0600), 0);
  EXPECT_FALSE(opens("fifo.ply"));  // an open() for reading would wait for a writer that never comes
}

TEST_F(ServedFileTest, AReplacedFileHasAnotherTag) {
  const std::string before = ServedFile::open(root_, "scene.ply")->etag();
  std::ofstream(base_ / "run" / "new.ply") << "9876543210";
  fs::rename(base_ / "run" / "new.ply", base_ / "run" / "scene.ply");
  const std::string after = ServedFile::open(root_, "scene.ply")->etag();
  EXPECT_NE(before, after);
  EXPECT_EQ(before.front(), '"');
  EXPECT_EQ(before.back(), '"');
}

}  // namespace
}  // namespace aligngs
