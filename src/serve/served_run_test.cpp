#include "serve/served_run.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// A run whose record names one of two scenes, with a photo each.
class PhotoRecordTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(base_);
    for (const char* scene : {"one", "two"}) write(fs::path(scene) / "images" / "view.png", scene);
    record("one");
    run_ = std::make_unique<ServedRun>(base_);
  }
  void TearDown() override { fs::remove_all(base_); }

  void write(const fs::path& name, const std::string& text) const {
    fs::create_directories((base_ / name).parent_path());
    std::ofstream(base_ / name, std::ios::binary) << text;
  }
  void record(const std::string& scene) const { write("run.json", R"({"scene": ")" + scene + "\"}"); }
  std::string photo() const {
    const auto file = run_->photo("view");
    return file ? file->content(100).value_or("too large") : "none";
  }

  fs::path base_ = fs::path(testing::TempDir()) / "aligngs_photo_record";
  std::unique_ptr<ServedRun> run_;
};

TEST_F(PhotoRecordTest, ARecordThatHasNotChangedIsNotReadAgain) {
  EXPECT_EQ(photo(), "one");
  const auto time = fs::last_write_time(base_ / "run.json");
  record("two");
  fs::last_write_time(base_ / "run.json", time);
  EXPECT_EQ(photo(), "one") << "its time and its size are those of before";
}

TEST_F(PhotoRecordTest, AnotherRecordIsReadAtOnce) {
  EXPECT_EQ(photo(), "one");
  const auto time = fs::last_write_time(base_ / "run.json");
  record("two");
  fs::last_write_time(base_ / "run.json", time + std::chrono::seconds(1));
  EXPECT_EQ(photo(), "two");
  fs::remove(base_ / "run.json");
  EXPECT_EQ(photo(), "none");
}

TEST_F(PhotoRecordTest, AFolderThatIsMadeLaterIsFound) {
  fs::rename(base_ / "one", base_ / "away");
  EXPECT_EQ(photo(), "none");
  fs::rename(base_ / "away", base_ / "one");
  EXPECT_EQ(photo(), "one");
}

}  // namespace
}  // namespace aligngs
