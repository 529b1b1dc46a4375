#include "batch/input_digest.h"

#include <gtest/gtest.h>

#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class InputDigestTest : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(testing::TempDir()) / "digest" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(base_);
    write_file_atomically(base_ / "photos" / "a.jpg", "first");
    write_file_atomically(base_ / "photos" / "more" / "b.jpg", "second");
    batch_.list = base_ / "rooms.tsv";
    room_.name = "hall";
    room_.source = "photos";
    room_.options = {"--config", "settings.toml"};
  }
  InputDigest digest() const { return digest_inputs(batch_, room_); }

  fs::path base_;
  Batch batch_;
  RoomEntry room_;
};

TEST_F(InputDigestTest, IsTheSameForTheSameInputs) { EXPECT_EQ(digest(), digest()); }

TEST_F(InputDigestTest, ContentCountsAndTheTimeOfAFileDoesNot) {
  const InputDigest before = digest();
  fs::last_write_time(base_ / "photos" / "a.jpg",
                      fs::last_write_time(base_ / "photos" / "a.jpg") + std::chrono::seconds(5));
  EXPECT_EQ(digest().content, before.content);
  EXPECT_NE(digest().quick, before.quick);
  write_file_atomically(base_ / "photos" / "a.jpg", "FIRST");
  EXPECT_NE(digest().content, before.content);
}

TEST_F(InputDigestTest, NamesOptionsAndFilesThatOptionsNameCount) {
  const InputDigest before = digest();
  write_file_atomically(base_ / "settings.toml", "seed = 1");
  const InputDigest with_settings = digest();
  EXPECT_NE(with_settings.content, before.content);
  room_.options.push_back("--strict");
  EXPECT_NE(digest().content, with_settings.content);
  room_.options.pop_back();
  fs::rename(base_ / "photos" / "a.jpg", base_ / "photos" / "c.jpg");
  EXPECT_NE(digest().content, with_settings.content);
}

TEST_F(InputDigestTest, FilesAreNotReadAgainWhereNothingChanged) {
  InputDigest known = digest();
  known.content = "as it was";
  EXPECT_EQ(digest_inputs(batch_, room_, known).content, "as it was");
}

TEST_F(InputDigestTest, AMissingSourceHasADigestUntilItAppears) {
  room_.source = "later";
  const InputDigest missing = digest();
  write_file_atomically(base_ / "later" / "a.jpg", "first");
  EXPECT_NE(digest().content, missing.content);
}

}  // namespace
}  // namespace aligngs
